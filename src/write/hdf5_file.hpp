#pragma once
/// A new HDF5 file: every call of the HDF5 C interface is checked, and its failure is an IoError with HDF5's own words.
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <hdf5.h>

#include "write/atomic_file.hpp"
#include "write/hdf5_storage.hpp"

namespace grainvdb {

/// An HDF5 identifier and how it is closed.
class Hdf5Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Hdf5Handle(hid_t id, Closer closer) : id_(id), closer_(closer) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept;
  Hdf5Handle& operator=(Hdf5Handle&&) = delete;
  ~Hdf5Handle();

  hid_t id() const { return id_; }
  /// Closes early; negative on failure, as HDF5 has it.
  herr_t close();

 private:
  hid_t id_;
  Closer closer_;
};

using Hdf5Dims = std::vector<hsize_t>;

/// Objects are named by their absolute path. T is float, double, std::uint8_t, std::int32_t, std::int64_t or
/// std::uint32_t.
/// The same calls give the same bytes: objects carry no time stamps.
class Hdf5File {
 public:
  explicit Hdf5File(AtomicFile& file);
  /// A file that was not closed is abandoned: nothing more is written.
  ~Hdf5File();
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  void create_group(const std::string& path);
  /// Another name for an object that exists: a hard link.
  void link(const std::string& path, const std::string& existing);

  template <class T>
  void create_dataset(const std::string& path, const Hdf5Dims& dims);
  /// Chunks that are never written take no space and read as `fill`.
  template <class T>
  void create_chunked_dataset(const std::string& path, const Hdf5Dims& dims, const Hdf5Dims& chunk, T fill);
  template <class T>
  void write(const std::string& path, std::span<const T> values);
  /// Writes one whole chunk, beyond the edge of the dataset included, straight to the file. `start` is its first
  /// element.
  template <class T>
  void write_chunk(const std::string& path, const Hdf5Dims& start, std::span<const T> values);
  /// No rows yet; chunk.size() is row.size() + 1, its first entry the rows per chunk.
  template <class T>
  void create_growing_dataset(const std::string& path, const Hdf5Dims& row, const Hdf5Dims& chunk);
  /// Adds one row to a growing dataset. Rows reach the file when their chunks are full, or when the file is closed.
  template <class T>
  void append_row(const std::string& path, std::span<const T> values);
  /// A scalar dataset with one UTF-8 text.
  void create_text(const std::string& path, const std::string& text);

  /// Makes the dataset a dimension scale of that name, and says that it is the scale along an axis of another.
  void make_scale(const std::string& path, const std::string& name);
  void attach_scale(const std::string& path, unsigned axis, const std::string& scale);

  template <class T>
  void attribute(const std::string& object, const std::string& name, std::span<const T> values);
  template <class T>
  void attribute(const std::string& object, const std::string& name, T value);
  void text_attribute(const std::string& object, const std::string& name, const std::string& text);
  void text_attribute(const std::string& object, const std::string& name, const std::vector<std::string>& texts);
  /// ASCII of fixed length without a terminating zero: the only text that VTK reads.
  void fixed_text_attribute(const std::string& object, const std::string& name, const std::string& text);

  /// Hands everything to the operating system.
  void flush();
  void close();

 private:
  template <class Result>
  Result check(Result result, const char* action, const std::string& object) const;
  Hdf5Handle checked(hid_t id, Hdf5Handle::Closer closer, const char* action, const std::string& object) const;
  void add_dataset(const std::string& path, hid_t type, hid_t space, const Hdf5Handle& properties);
  void write_attribute(const std::string& object, const std::string& name, hid_t type,
                       const std::optional<Hdf5Dims>& dims, const void* values);
  Hdf5Handle dataset_properties() const;
  Hdf5Handle text_type() const;
  const Hdf5Handle& dataset(const std::string& path) const;

  AtomicFile& target_;
  Hdf5Storage storage_;
  std::optional<Hdf5Handle> file_;
  std::map<std::string, Hdf5Handle> datasets_;
};

}  // namespace grainvdb
