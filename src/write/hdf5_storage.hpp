#pragma once
/// HDF5's access to its file, through an AtomicFile.
///
/// The library's own drivers cannot be used where a disk may be full: when HDF5 1.10 fails to write while it closes a
/// file, it keeps half of its state and crashes when that is touched again, at the latest when the process ends. So
/// the first failure is kept here, HDF5 is told that all is well, nothing more is written, and whoever called HDF5 asks
/// afterwards. HDF5 then closes in good order, and the error is the system's own.
#include <cstddef>
#include <cstdint>
#include <exception>
#include <span>

#include <hdf5.h>

#include "write/atomic_file.hpp"

namespace grainvdb {

class Hdf5Storage {
 public:
  explicit Hdf5Storage(AtomicFile& file) : file_(file) {}

  /// A file access property list by which H5Fcreate uses this storage, whatever file name it is given; negative on
  /// failure.
  hid_t access_properties();

  void write(std::uint64_t offset, std::span<const std::byte> bytes) noexcept;
  bool read(std::uint64_t offset, std::span<std::byte> bytes) noexcept;
  void resize(std::uint64_t size) noexcept;

  /// From now on nothing is written: the file is not wanted any more.
  void discard() noexcept { discarded_ = true; }
  /// Throws the first failure, if there was one.
  void rethrow_failure() const;

 private:
  template <class Action>
  bool attempt(Action&& action) noexcept;

  AtomicFile& file_;
  std::exception_ptr failure_;
  bool discarded_ = false;
};

}  // namespace grainvdb
