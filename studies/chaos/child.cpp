#include "studies/chaos/child.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

namespace isochor::studies {

namespace {

constexpr double kWallOverProcessor = 10;
constexpr char kBetween = '\x1f';

std::string encoded(const ChaosOutcome& o) {
  char numbers[300];
  std::snprintf(numbers, sizeof numbers, "%d%c%d%c%d%c%d%c%.9g%c%.9g%c%.9g%c%ld%c",
                static_cast<int>(o.verdict), kBetween, o.steps, kBetween, o.asked, kBetween, o.iterations,
                kBetween, o.seconds, kBetween, o.overshoot, kBetween, o.min_J, kBetween, o.inverted,
                kBetween);
  return numbers + o.kind + kBetween + o.reason + kBetween;
}

bool decode(const std::string& text, ChaosOutcome& o) {
  std::vector<std::string> part(1);
  for (const char c : text) {
    if (c == kBetween)
      part.emplace_back();
    else
      part.back() += c;
  }
  if (part.size() != 11) return false;
  o.verdict = static_cast<ChaosVerdict>(std::clamp(std::atoi(part[0].c_str()), 0, 4));
  o.steps = std::atoi(part[1].c_str());
  o.asked = std::atoi(part[2].c_str());
  o.iterations = std::atoi(part[3].c_str());
  o.seconds = std::atof(part[4].c_str());
  o.overshoot = std::atof(part[5].c_str());
  o.min_J = std::atof(part[6].c_str());
  o.inverted = std::atol(part[7].c_str());
  o.kind = part[8];
  o.reason = part[9];
  return true;
}

void send(int pipe, const std::string& text) {
  std::size_t sent = 0;
  while (sent < text.size()) {
    const ssize_t n = ::write(pipe, text.data() + sent, text.size() - sent);
    if (n <= 0 && errno != EINTR) return;
    if (n > 0) sent += static_cast<std::size_t>(n);
  }
}

// In the child: nothing returns from here.
[[noreturn]] void work_and_exit(const std::function<ChaosOutcome()>& work, const std::string& folder,
                                double limit, int pipe) {
  std::signal(SIGINT, SIG_IGN);  // the parent ends what it began
  std::signal(SIGTERM, SIG_DFL);
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  const auto seconds = static_cast<rlim_t>(std::ceil(std::max(limit, 1.0)));
  const rlimit processor{seconds, seconds + 5};
  setrlimit(RLIMIT_CPU, &processor);
  std::signal(SIGXCPU, SIG_DFL);
#ifndef __SANITIZE_ADDRESS__
  // Handlers of a test program are for the program itself.
  for (const int s : {SIGABRT, SIGSEGV, SIGFPE, SIGILL, SIGBUS}) std::signal(s, SIG_DFL);
#endif
  // Whatever a library or a sanitizer prints belongs to the seed.
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  const int errors = ::open((folder + "/errors.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (errors >= 0) dup2(errors, 2);
  send(pipe, encoded(work()));
  ::close(pipe);
  _exit(0);
}

// What the process printed before it ended, in a line.
std::string last_words(const std::string& folder) {
  std::ifstream in(folder + "/errors.txt");
  std::string line, text;
  while (std::getline(in, line) && text.size() < 400) {
    if (line.find("ERROR") != std::string::npos || line.find("error") != std::string::npos || text.empty())
      text += (text.empty() ? "" : " | ") + line;
  }
  return text;
}

}  // namespace

ChaosChild::ChaosChild(std::uint64_t seed, std::string folder, double limit,
                       const std::function<ChaosOutcome()>& work)
    : seed_(seed), folder_(std::move(folder)), limit_(limit), start_(std::chrono::steady_clock::now()) {
  int ends[2];
  if (::pipe(ends) != 0) return;
  std::fflush(nullptr);
  process_ = fork();
  if (process_ == 0) {
    ::close(ends[0]);
    work_and_exit(work, folder_, limit_, ends[1]);
  }
  ::close(ends[1]);
  pipe_ = ends[0];
  fcntl(pipe_, F_SETFL, O_NONBLOCK);
  fcntl(pipe_, F_SETFD, FD_CLOEXEC);
}

ChaosChild::ChaosChild(ChaosChild&& other) noexcept
    : seed_(other.seed_),
      folder_(std::move(other.folder_)),
      limit_(other.limit_),
      process_(std::exchange(other.process_, -1)),
      pipe_(std::exchange(other.pipe_, -1)),
      status_(other.status_),
      too_long_(other.too_long_),
      text_(std::move(other.text_)),
      start_(other.start_) {}

ChaosChild::~ChaosChild() {
  kill_and_wait();
}

void ChaosChild::kill_and_wait() {
  if (process_ > 0) {
    kill(process_, SIGKILL);
    waitpid(process_, &status_, 0);
  }
  process_ = -1;
  if (pipe_ >= 0) ::close(pipe_);
  pipe_ = -1;
}

bool ChaosChild::ended() {
  if (process_ < 0) return true;
  char block[4096];
  for (ssize_t n = 0; (n = ::read(pipe_, block, sizeof block)) > 0;)
    text_.append(block, static_cast<std::size_t>(n));
  if (waitpid(process_, &status_, WNOHANG) == process_) {
    process_ = -1;
    for (ssize_t n = 0; (n = ::read(pipe_, block, sizeof block)) > 0;)
      text_.append(block, static_cast<std::size_t>(n));
    return true;
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start_;
  // Other work on the machine may slow it down; what waits for nothing uses no processor time.
  if (taken.count() < kWallOverProcessor * limit_) return false;
  too_long_ = true;
  kill_and_wait();
  return true;
}

ChaosOutcome ChaosChild::outcome() {
  ChaosOutcome out;
  out.seed = seed_;
  if (pipe_ < 0 && !too_long_) {
    out.kind = "no process";
    out.reason = "a process for the seed could not be made";
  } else if (too_long_ || (WIFSIGNALED(status_) && WTERMSIG(status_) == SIGXCPU)) {
    out.kind = "hang";
    out.reason =
        "it had not ended after " + std::to_string(static_cast<int>(limit_)) + " s of processor time";
    out.seconds = limit_;
  } else if (WIFSIGNALED(status_)) {
    out.kind = "crash";
    out.reason = std::string(strsignal(WTERMSIG(status_))) + "; " + last_words(folder_);
  } else if (WEXITSTATUS(status_) != 0 || !decode(text_, out)) {
    out.kind = "crash";
    out.reason = "exit code " + std::to_string(WEXITSTATUS(status_)) + "; " + last_words(folder_);
  }
  return out;
}

}  // namespace isochor::studies
