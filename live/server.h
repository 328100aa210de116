// The server of live scenes: HTTP around a hub.
#pragma once

#include <memory>
#include <string>

#include "live/hub.h"

namespace isochor::live {

struct ServerOptions {
  std::string host = "127.0.0.1";
  int port = 0;      // 0: any that is free
  std::string page;  // the HTML that viewers get
};

class Server {
 public:
  // Listens from here on; refused where the address cannot be had.
  static Result<std::unique_ptr<Server>> start(Hub& hub, const ServerOptions& options);
  ~Server();  // stops

  int port() const;
  // With the token, which is behind #: browsers do not send that part to anyone.
  std::string link() const;
  void stop();

 private:
  struct Impl;
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace isochor::live
