#pragma once
/// Reads HDF5 files by the C interface alone, independently of the code that wrote them.
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <hdf5.h>

namespace grainvdb::testing {

class Hdf5Reader {
 public:
  explicit Hdf5Reader(const std::string& path) : file_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)) {
    if (file_ < 0) throw std::runtime_error("cannot open " + path);
  }
  ~Hdf5Reader() { H5Fclose(file_); }
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;

  hid_t id() const { return file_; }
  bool has(const std::string& path) const { return H5Lexists(file_, path.c_str(), H5P_DEFAULT) > 0; }
  bool has_attribute(const std::string& object, const std::string& name) const {
    return H5Aexists_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT) > 0;
  }

  std::vector<hsize_t> dims(const std::string& path) const {
    const hid_t set = open(path);
    const hid_t space = H5Dget_space(set);
    std::vector<hsize_t> result(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
    H5Sget_simple_extent_dims(space, result.data(), nullptr);
    H5Sclose(space);
    H5Dclose(set);
    return result;
  }
  std::vector<hsize_t> chunk(const std::string& path) const {
    const hid_t set = open(path);
    const hid_t properties = H5Dget_create_plist(set);
    std::vector<hsize_t> result(dims(path).size());
    H5Pget_chunk(properties, static_cast<int>(result.size()), result.data());
    H5Pclose(properties);
    H5Dclose(set);
    return result;
  }
  std::uint64_t storage_size(const std::string& path) const {
    const hid_t set = open(path);
    const std::uint64_t size = H5Dget_storage_size(set);
    H5Dclose(set);
    return size;
  }
  template <class T>
  T fill_value(const std::string& path) const {
    const hid_t set = open(path);
    const hid_t properties = H5Dget_create_plist(set);
    T value{};
    H5Pget_fill_value(properties, native(T{}), &value);
    H5Pclose(properties);
    H5Dclose(set);
    return value;
  }
  template <class T>
  std::vector<T> read(const std::string& path) const {
    std::size_t n = 1;
    for (const hsize_t d : dims(path)) n *= d;
    std::vector<T> values(n);
    const hid_t set = open(path);
    if (H5Dread(set, native(T{}), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) throw std::runtime_error(path);
    H5Dclose(set);
    return values;
  }
  bool stored_as(const std::string& path, hid_t type) const {
    const hid_t set = open(path);
    const hid_t stored = H5Dget_type(set);
    const bool equal = H5Tequal(stored, type) > 0;
    H5Tclose(stored);
    H5Dclose(set);
    return equal;
  }
  /// A text of fixed length, which is all that Octave reads.
  std::string text(const std::string& path) const {
    const hid_t set = open(path);
    const hid_t type = H5Dget_type(set);
    if (H5Tis_variable_str(type) != 0) throw std::runtime_error(path + " is no text of fixed length");
    std::string result(H5Tget_size(type), '\0');
    H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, result.data());
    result.erase(result.find_last_not_of('\0') + 1);
    H5Tclose(type);
    H5Dclose(set);
    return result;
  }

  template <class T>
  std::vector<T> attribute(const std::string& object, const std::string& name) const {
    const hid_t a = open_attribute(object, name);
    const hid_t space = H5Aget_space(a);
    std::vector<T> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    H5Aread(a, native(T{}), values.data());
    H5Sclose(space);
    H5Aclose(a);
    return values;
  }
  bool attribute_stored_as(const std::string& object, const std::string& name, hid_t type) const {
    const hid_t a = open_attribute(object, name);
    const hid_t stored = H5Aget_type(a);
    const bool equal = H5Tequal(stored, type) > 0;
    H5Tclose(stored);
    H5Aclose(a);
    return equal;
  }
  /// Texts of variable length.
  std::vector<std::string> texts_of(const std::string& object, const std::string& name) const {
    const hid_t a = open_attribute(object, name);
    const hid_t type = H5Aget_type(a);
    const hid_t space = H5Aget_space(a);
    std::vector<char*> characters(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    if (H5Tis_variable_str(type) <= 0) throw std::runtime_error(name + " is no text of variable length");
    H5Aread(a, type, characters.data());
    std::vector<std::string> result;
    for (char* c : characters) result.push_back(taken(c));
    H5Sclose(space);
    H5Tclose(type);
    H5Aclose(a);
    return result;
  }
  std::string text_of(const std::string& object, const std::string& name) const { return texts_of(object, name).at(0); }

 private:
  static hid_t native(float) { return H5T_NATIVE_FLOAT; }
  static hid_t native(double) { return H5T_NATIVE_DOUBLE; }
  static hid_t native(std::uint8_t) { return H5T_NATIVE_UINT8; }
  static hid_t native(std::int32_t) { return H5T_NATIVE_INT32; }
  static hid_t native(std::int64_t) { return H5T_NATIVE_INT64; }
  static hid_t native(std::uint32_t) { return H5T_NATIVE_UINT32; }
  static std::string taken(char* characters) {
    const std::string result = characters == nullptr ? "" : characters;
    H5free_memory(characters);
    return result;
  }
  hid_t open(const std::string& path) const {
    const hid_t set = H5Dopen2(file_, path.c_str(), H5P_DEFAULT);
    if (set < 0) throw std::runtime_error("no dataset " + path);
    return set;
  }
  hid_t open_attribute(const std::string& object, const std::string& name) const {
    const hid_t a = H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    if (a < 0) throw std::runtime_error("no attribute " + name + " of " + object);
    return a;
  }

  hid_t file_;
};

}  // namespace grainvdb::testing
