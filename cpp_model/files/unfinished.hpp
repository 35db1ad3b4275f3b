// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Files that are being written when a program ends before its time: stopped by a signal, or killed.
#pragma once

#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>

namespace raypool {

/// A signal has asked for the program's end where KeepRunning holds; stop_point() throws it.
struct Stopped : std::runtime_error {
  explicit Stopped(int which);
  int signal;
};

/// From now on SIGINT, SIGTERM, SIGHUP and SIGPIPE, unless they are ignored, remove the temporary files of all
/// OutputFiles before they end the program. For main(): a library leaves signals alone.
void handle_stop_signals();

/// While one lives, such a signal ends the program only at the next stop_point(), so that what is being written can be
/// finished. A second signal, two seconds after the first or later, ends it at once.
class KeepRunning {
 public:
  KeepRunning();
  ~KeepRunning();
  KeepRunning(const KeepRunning&) = delete;
  KeepRunning& operator=(const KeepRunning&) = delete;
};

/// Throws Stopped if a signal has come. Costs next to nothing.
void stop_point();

/// The first signal that came while a KeepRunning lived; 0: none.
int stop_signal();

/// Ends the program as the signal does when no handler is set.
[[noreturn]] void end_by(int signal);

/// Registers the path of a file for the signals to remove while it lives.
class RemovedWhenStopped {
 public:
  explicit RemovedWhenStopped(const std::filesystem::path& path);
  ~RemovedWhenStopped();
  RemovedWhenStopped(RemovedWhenStopped&& other) noexcept;
  RemovedWhenStopped& operator=(RemovedWhenStopped&& other) noexcept;

 private:
  int place_ = -1;
};

/// Holds a folder while files are written into it, for as long as it lives, so that others know that a program which
/// writes there is alive. Where the file system has no such locks it holds nothing.
class FolderHold {
 public:
  explicit FolderHold(const std::filesystem::path& folder);
  ~FolderHold();
  FolderHold(FolderHold&& other) noexcept;
  FolderHold& operator=(FolderHold&& other) noexcept;

  /// Of the file `name` what programs have left that were killed while they wrote it, under the names of
  /// temporary_name(), unless another process holds the folder. A waveform (.fst) gets the name killed-PID-NAME, with
  /// what lies beside it; everything else is removed. Calls what tell_unfinished() has set.
  void clear(const std::string& name);

 private:
  std::filesystem::path folder_;
  int file_ = -1;
};

/// ".PID.NAME": keeps two runs apart and NAME's ending, which writers of pictures and waveforms look at.
std::string temporary_name(const std::string& name);

/// Sets what is called with a sentence for each file that FolderHold::clear() finds; by default nothing is.
void tell_unfinished(std::function<void(const std::string&)> tell);

}  // namespace raypool
