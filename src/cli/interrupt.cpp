// SPDX-License-Identifier: BSD-3-Clause
#include "interrupt.hpp"

#include <csignal>
#include <unistd.h>

namespace agrisee::cli {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM};

std::string stop_message;  // not changed while a handler is installed
int living = 0;            // number of StopMessages

/// Print the message and end the process by the same signal, so that a shell sees what ended it.
extern "C" void on_stop(int signal) {
  const ssize_t ignored = ::write(STDERR_FILENO, stop_message.data(), stop_message.size());
  static_cast<void>(ignored);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

}  // namespace

StopMessage::StopMessage(const std::string& message) {
  if (living++ > 0) return;
  stop_message = "\n" + message + "\n";
  for (const int signal : kSignals)
    if (std::signal(signal, on_stop) == SIG_IGN) std::signal(signal, SIG_IGN);  // as under nohup
}

StopMessage::~StopMessage() {
  if (--living > 0) return;
  for (const int signal : kSignals)
    if (std::signal(signal, SIG_DFL) == SIG_IGN) std::signal(signal, SIG_IGN);
}

std::string shell_word(const std::string& path) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+:=@%,";
  if (!path.empty() && path.find_first_not_of(kPlain) == std::string::npos) return path;
  std::string out = "'";
  for (const char c : path) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

}  // namespace agrisee::cli
