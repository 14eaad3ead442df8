// SPDX-License-Identifier: BSD-3-Clause
// What the command says when the user stops it.
#pragma once

#include <string>

namespace agrisee::cli {

/// While an object of this class lives, a signal to stop (Ctrl-C, or SIGTERM) prints `message` to stderr before it ends
/// the process. While several live, the first one's counts: a list of scans knows better how to go on than one of them.
class StopMessage {
 public:
  explicit StopMessage(const std::string& message);
  StopMessage(const StopMessage&) = delete;
  StopMessage& operator=(const StopMessage&) = delete;
  ~StopMessage();
};

/// A path as a word of a shell's command line: quoted if it needs to be.
std::string shell_word(const std::string& path);

}  // namespace agrisee::cli
