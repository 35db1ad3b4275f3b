// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Reading of files that a user names: the whole of it, or one sentence why not.
#pragma once

#include <functional>
#include <string>

namespace raypool {

/// The file's bytes. Throws InputError with the system's reason when it cannot be read, or is a folder; `what`
/// names it in the sentence: "view file".
std::string read_file(const std::string& path, const std::string& what);

/// The same of a text file, without a byte order mark of UTF-8. Throws InputError too when the text is UTF-16 or
/// UTF-32. Whatever reads text that a user has written reads it with this; binary data behind a text are kept.
std::string read_text_file(const std::string& path, const std::string& what);

/// While it lives, it is told of each file that read_file() reads in its thread, or cannot read, and of those that
/// tell_missing() names: null then.
class FilesRead {
 public:
  using Told = std::function<void(const std::string& path, const std::string* bytes)>;
  explicit FilesRead(Told told);
  ~FilesRead();
  FilesRead(const FilesRead&) = delete;
  FilesRead& operator=(const FilesRead&) = delete;

 private:
  Told told_;
  const Told* before_;
};

/// A file was looked for under this name, and is not there.
void tell_missing(const std::string& path);

/// Lines end in "\n" afterwards, whether they ended so, in "\r\n" (or more of "\r"), or in "\r" alone.
void use_line_feeds(std::string& text);

}  // namespace raypool
