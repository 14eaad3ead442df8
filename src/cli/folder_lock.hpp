// SPDX-License-Identifier: BSD-3-Clause
// Keeps two processes from working in one result folder.
#pragma once

#include <agrisee/core/error.hpp>

#include <string>

namespace agrisee::cli {

/// Another process works in a folder.
struct FolderBusy : FileError {
  using FileError::FileError;
};

/// A lock on a folder, which ends with this object or its process, however that ends. Where the file system knows no
/// locks on folders there is none.
class FolderLock {
 public:
  FolderLock() = default;
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

  /// Lock a folder, if it exists and this object has no lock yet. @throws FolderBusy if another process has locked it
  void take(const std::string& folder);

 private:
  int descriptor_ = -1;
};

}  // namespace agrisee::cli
