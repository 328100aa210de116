#include "live/server.h"

#include <httplib.h>

#include <thread>

namespace isochor::live {

namespace {

constexpr const char* kToken = "X-Isochor-Token";
constexpr const char* kViewer = "X-Isochor-Viewer";
// Connections at a time; each waits in a thread of its own.
constexpr std::size_t kThreads = 48;

// The page brings all it needs; it may talk to its own server alone and stand in no other page.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

void send(httplib::Response& response, const Answer& answer) {
  response.status = answer.status;
  response.set_content(answer.body, answer.binary ? "application/octet-stream" : "application/json");
}

}  // namespace

struct Server::Impl {
  Impl(Hub& h, const ServerOptions& o) : hub(h), options(o), token(random_token()) {}

  // Whether a request may come through; where not, the answer says why.
  bool admit(const httplib::Request& request, httplib::Response& response);
  void serve();

  Hub& hub;
  ServerOptions options;
  std::string token;
  int port = 0;
  std::unique_ptr<Names> names;
  httplib::Server http;
  std::thread thread;
};

bool Server::Impl::admit(const httplib::Request& request, httplib::Response& response) {
  const auto refuse = [&](int status, const char* sentence) {
    hub.count_refusal();
    send(response, {status, error_message(sentence), false});
    return false;
  };
  const std::string host = request.get_header_value("Host");
  if (!names->host_allowed(host))
    return refuse(403, "this server is not known under that name; open the link that it has printed");
  if (!names->origin_allowed(request.get_header_value("Origin"), host))
    return refuse(403, "pages of other sites may not talk to this server");
  if (request.path == "/" && request.method == "GET") return true;
  if (!same_secret(request.get_header_value(kToken), token))
    return refuse(401, "the token is missing or wrong; open the link that the server has printed");
  return true;
}

void Server::Impl::serve() {
  http.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  http.set_payload_max_length(largest_message);
  http.set_read_timeout(3);
  http.set_write_timeout(5);
  http.set_keep_alive_timeout(4);
  http.set_keep_alive_max_count(100000);
  http.set_tcp_nodelay(true);
  http.set_default_headers({{"Content-Security-Policy", kPolicy},
                            {"X-Content-Type-Options", "nosniff"},
                            {"Referrer-Policy", "no-referrer"},
                            {"Cross-Origin-Resource-Policy", "same-origin"},
                            {"Cache-Control", "no-store"}});
  http.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
    return admit(request, response) ? httplib::Server::HandlerResponse::Unhandled
                                    : httplib::Server::HandlerResponse::Handled;
  });
  http.set_error_handler([this](const httplib::Request&, httplib::Response& response) {
    if (!response.body.empty()) return;
    hub.count_refusal();
    response.set_content(error_message("there is no such thing here, or the message is too large"),
                         "application/json");
  });
  http.Get("/", [this](const httplib::Request&, httplib::Response& response) {
    response.set_content(options.page, "text/html; charset=utf-8");
  });
  http.Post("/join", [this](const httplib::Request&, httplib::Response& response) {
    send(response, hub.join(Hub::Clock::now()));
  });
  http.Post("/leave", [this](const httplib::Request& request, httplib::Response& response) {
    send(response, hub.leave(request.get_header_value(kViewer)));
  });
  http.Get("/scene", [this](const httplib::Request& request, httplib::Response& response) {
    send(response, hub.scene(request.get_header_value(kViewer), Hub::Clock::now()));
  });
  http.Get("/picture", [this](const httplib::Request& request, httplib::Response& response) {
    send(response, hub.picture(request.get_header_value(kViewer), request.get_param_value("after"),
                               request.get_param_value("field"), request.get_param_value("wants")));
  });
  http.Post("/command", [this](const httplib::Request& request, httplib::Response& response) {
    send(response, hub.command(request.get_header_value(kViewer), request.body, Hub::Clock::now()));
  });
}

Server::Server(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Server::~Server() {
  stop();
}

Result<std::unique_ptr<Server>> Server::start(Hub& hub, const ServerOptions& options) {
  auto impl = std::make_unique<Impl>(hub, options);
  if (impl->token.empty()) return Error{"the system has no random numbers to make a token of"};
  httplib::Server& http = impl->http;
  // Without SO_REUSEPORT, which is the library's way: another process could listen on the same port.
  http.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  impl->serve();
  if (options.port == 0)
    impl->port = http.bind_to_any_port(options.host);
  else
    impl->port = http.bind_to_port(options.host, options.port) ? options.port : -1;
  if (impl->port <= 0) {
    return Error{"cannot listen on " + options.host + ", port " + std::to_string(options.port) +
                 ": the port is in use, or this machine has no such address; leave --port out for one that "
                 "is free"};
  }
  impl->names = std::make_unique<Names>(options.host, impl->port);
  Impl* self = impl.get();
  impl->thread = std::thread([self] {
    // Its helpers inherit the name, by which viewer/measure_live.mjs knows what they cost.
    pthread_setname_np(pthread_self(), "isochor-http");
    self->http.listen_after_bind();
  });
  return std::unique_ptr<Server>(new Server(std::move(impl)));
}

int Server::port() const {
  return impl_->port;
}

std::string Server::link() const {
  const std::string& host = impl_->options.host;
  const bool any = host == "0.0.0.0" || host == "::";
  const std::string name = any ? "127.0.0.1" : host.find(':') != std::string::npos ? "[" + host + "]" : host;
  return "http://" + name + ":" + std::to_string(impl_->port) + "/#token=" + impl_->token;
}

void Server::stop() {
  if (!impl_->thread.joinable()) return;
  // A stop that comes before the thread has begun to listen would be forgotten.
  while (!impl_->http.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  impl_->http.stop();
  impl_->thread.join();
}

}  // namespace isochor::live
