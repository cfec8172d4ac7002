#include "write/hdf5_file.hpp"

#include <algorithm>
#include <utility>

#include <hdf5_hl.h>

#include "grainvdb/error.hpp"

namespace grainvdb {
namespace {

/// Keeps HDF5 from printing its errors to the terminal for as long as it lives.
class Quiet {
 public:
  Quiet() {
    H5Eget_auto2(H5E_DEFAULT, &printer_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, printer_, data_); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  H5E_auto2_t printer_ = nullptr;
  void* data_ = nullptr;
};

/// What HDF5 says went wrong: of its stack of errors, the one that started it.
std::string hdf5_reason() {
  std::string reason;
  const auto take = [](unsigned n, const H5E_error2_t* error, void* text) -> herr_t {
    if (n == 0 && error->desc != nullptr) *static_cast<std::string*>(text) = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take, &reason);
  return reason.empty() ? "no reason given" : reason;
}

template <class T>
hid_t hdf5_type();
template <>
hid_t hdf5_type<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
hid_t hdf5_type<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
hid_t hdf5_type<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}
template <>
hid_t hdf5_type<std::int32_t>() {
  return H5T_NATIVE_INT32;
}
template <>
hid_t hdf5_type<std::int64_t>() {
  return H5T_NATIVE_INT64;
}
template <>
hid_t hdf5_type<std::uint32_t>() {
  return H5T_NATIVE_UINT32;
}

hid_t make_space(const std::optional<Hdf5Dims>& dims) {
  return dims ? H5Screate_simple(static_cast<int>(dims->size()), dims->data(), nullptr) : H5Screate(H5S_SCALAR);
}

}  // namespace

Hdf5Handle::Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), closer_(other.closer_) {}

Hdf5Handle::~Hdf5Handle() {
  if (id_ >= 0) closer_(id_);
}

herr_t Hdf5Handle::close() {
  return closer_(std::exchange(id_, -1));
}

template <class Result>
Result Hdf5File::check(Result result, const char* action, const std::string& object) const {
  storage_.rethrow_failure();
  if (result >= 0) return result;
  throw IoError(std::string("cannot ") + action + ' ' + object + ": HDF5 says: " + hdf5_reason(), target_.path(), 0);
}

Hdf5Handle Hdf5File::checked(hid_t id, Hdf5Handle::Closer closer, const char* action, const std::string& object) const {
  return {check(id, action, object), closer};
}

Hdf5File::Hdf5File(AtomicFile& file) : target_(file), storage_(file) {
  const Quiet quiet;
  const auto creation = checked(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "create", "/");
  check(H5Pset_obj_track_times(creation.id(), false), "create", "/");
  const auto access = checked(storage_.access_properties(), H5Pclose, "create", "/");
  file_.emplace(checked(H5Fcreate(file.temporary_path().c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose,
                        "create", "/"));
}

Hdf5File::~Hdf5File() {
  const Quiet quiet;
  storage_.discard();
  datasets_.clear();
  file_.reset();
}

void Hdf5File::close() {
  const Quiet quiet;
  for (auto& [path, handle] : datasets_) check(handle.close(), "close", path);
  datasets_.clear();
  check(file_->close(), "close", "/");
}

void Hdf5File::flush() {
  const Quiet quiet;
  check(H5Fflush(file_->id(), H5F_SCOPE_GLOBAL), "flush", "/");
}

void Hdf5File::create_group(const std::string& path) {
  const Quiet quiet;
  const auto creation = checked(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "create", path);
  check(H5Pset_obj_track_times(creation.id(), false), "create", path);
  auto group =
      checked(H5Gcreate2(file_->id(), path.c_str(), H5P_DEFAULT, creation.id(), H5P_DEFAULT), H5Gclose, "create", path);
  check(group.close(), "close", path);
}

void Hdf5File::link(const std::string& path, const std::string& existing) {
  const Quiet quiet;
  check(H5Lcreate_hard(file_->id(), existing.c_str(), file_->id(), path.c_str(), H5P_DEFAULT, H5P_DEFAULT), "create",
        path);
}

Hdf5Handle Hdf5File::dataset_properties() const {
  auto properties = checked(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "create", "a dataset");
  check(H5Pset_obj_track_times(properties.id(), false), "create", "a dataset");
  return properties;
}

Hdf5Handle Hdf5File::text_type() const {
  auto type = checked(H5Tcopy(H5T_C_S1), H5Tclose, "describe", "a text");
  check(H5Tset_size(type.id(), H5T_VARIABLE), "describe", "a text");
  check(H5Tset_cset(type.id(), H5T_CSET_UTF8), "describe", "a text");
  return type;
}

const Hdf5Handle& Hdf5File::dataset(const std::string& path) const {
  return datasets_.at(path);
}

void Hdf5File::add_dataset(const std::string& path, hid_t type, hid_t space, const Hdf5Handle& properties) {
  datasets_.emplace(
      path, checked(H5Dcreate2(file_->id(), path.c_str(), type, space, H5P_DEFAULT, properties.id(), H5P_DEFAULT),
                    H5Dclose, "create", path));
}

template <class T>
void Hdf5File::create_dataset(const std::string& path, const Hdf5Dims& dims) {
  const Quiet quiet;
  const auto space = checked(make_space(dims), H5Sclose, "create", path);
  add_dataset(path, hdf5_type<T>(), space.id(), dataset_properties());
}

template <class T>
void Hdf5File::create_chunked_dataset(const std::string& path, const Hdf5Dims& dims, const Hdf5Dims& chunk, T fill) {
  const Quiet quiet;
  const auto properties = dataset_properties();
  const hid_t p = properties.id();
  check(H5Pset_chunk(p, static_cast<int>(chunk.size()), chunk.data()), "create", path);
  check(H5Pset_fill_value(p, hdf5_type<T>(), &fill), "create", path);
  check(H5Pset_fill_time(p, H5D_FILL_TIME_IFSET), "create", path);
  check(H5Pset_alloc_time(p, H5D_ALLOC_TIME_INCR), "create", path);
  const auto space = checked(make_space(dims), H5Sclose, "create", path);
  add_dataset(path, hdf5_type<T>(), space.id(), properties);
}

template <class T>
void Hdf5File::create_growing_dataset(const std::string& path, const Hdf5Dims& row, const Hdf5Dims& chunk) {
  const Quiet quiet;
  const auto properties = dataset_properties();
  check(H5Pset_chunk(properties.id(), static_cast<int>(chunk.size()), chunk.data()), "create", path);
  Hdf5Dims dims{0}, most{H5S_UNLIMITED};
  dims.insert(dims.end(), row.begin(), row.end());
  most.insert(most.end(), row.begin(), row.end());
  const auto space =
      checked(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), most.data()), H5Sclose, "create", path);
  add_dataset(path, hdf5_type<T>(), space.id(), properties);
}

template <class T>
void Hdf5File::append_row(const std::string& path, std::span<const T> values) {
  const Quiet quiet;
  const hid_t set = dataset(path).id();
  Hdf5Dims dims;
  {
    const auto space = checked(H5Dget_space(set), H5Sclose, "write", path);
    dims.resize(static_cast<std::size_t>(check(H5Sget_simple_extent_ndims(space.id()), "write", path)));
    check(H5Sget_simple_extent_dims(space.id(), dims.data(), nullptr), "write", path);
  }
  Hdf5Dims start(dims.size(), 0), count = dims;
  start.front() = dims.front()++;
  count.front() = 1;
  check(H5Dset_extent(set, dims.data()), "write", path);
  const auto all = checked(H5Dget_space(set), H5Sclose, "write", path);
  check(H5Sselect_hyperslab(all.id(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr), "write", path);
  const auto row = checked(make_space(count), H5Sclose, "write", path);
  check(H5Dwrite(set, hdf5_type<T>(), row.id(), all.id(), H5P_DEFAULT, values.data()), "write", path);
}

template <class T>
void Hdf5File::write(const std::string& path, std::span<const T> values) {
  const Quiet quiet;
  check(H5Dwrite(dataset(path).id(), hdf5_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "write", path);
}

template <class T>
void Hdf5File::write_chunk(const std::string& path, const Hdf5Dims& start, std::span<const T> values) {
  const Quiet quiet;
  check(H5Dwrite_chunk(dataset(path).id(), H5P_DEFAULT, 0, start.data(), values.size_bytes(), values.data()), "write",
        path);
}

void Hdf5File::create_text(const std::string& path, const std::string& text) {
  const Quiet quiet;
  // Of fixed length, and ASCII where it is: Octave reads no others, and nothing that comes after one.
  const auto type = checked(H5Tcopy(H5T_C_S1), H5Tclose, "describe", path);
  check(H5Tset_size(type.id(), std::max<std::size_t>(text.size(), 1)), "describe", path);
  check(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), "describe", path);
  const bool ascii = std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  check(H5Tset_cset(type.id(), ascii ? H5T_CSET_ASCII : H5T_CSET_UTF8), "describe", path);
  const auto properties = dataset_properties();
  const auto space = checked(make_space(std::nullopt), H5Sclose, "create", path);
  auto set =
      checked(H5Dcreate2(file_->id(), path.c_str(), type.id(), space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
              H5Dclose, "create", path);
  check(H5Dwrite(set.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()), "write", path);
  check(set.close(), "close", path);
}

void Hdf5File::make_scale(const std::string& path, const std::string& name) {
  const Quiet quiet;
  check(H5DSset_scale(dataset(path).id(), name.c_str()), "make a dimension scale of", path);
}

void Hdf5File::attach_scale(const std::string& path, unsigned axis, const std::string& scale) {
  const Quiet quiet;
  check(H5DSattach_scale(dataset(path).id(), dataset(scale).id(), axis), "attach a dimension scale to", path);
}

void Hdf5File::write_attribute(const std::string& object, const std::string& name, hid_t type,
                               const std::optional<Hdf5Dims>& dims, const void* values) {
  const auto space = checked(make_space(dims), H5Sclose, "describe", object);
  auto attribute = checked(H5Acreate_by_name(file_->id(), object.c_str(), name.c_str(), type, space.id(), H5P_DEFAULT,
                                             H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose, "describe", object);
  check(H5Awrite(attribute.id(), type, values), "describe", object);
  check(attribute.close(), "describe", object);
}

template <class T>
void Hdf5File::attribute(const std::string& object, const std::string& name, std::span<const T> values) {
  const Quiet quiet;
  write_attribute(object, name, hdf5_type<T>(), Hdf5Dims{values.size()}, values.data());
}

template <class T>
void Hdf5File::attribute(const std::string& object, const std::string& name, T value) {
  const Quiet quiet;
  write_attribute(object, name, hdf5_type<T>(), std::nullopt, &value);
}

void Hdf5File::text_attribute(const std::string& object, const std::string& name, const std::string& text) {
  const Quiet quiet;
  const auto type = text_type();
  const char* characters = text.c_str();
  write_attribute(object, name, type.id(), std::nullopt, &characters);
}

void Hdf5File::text_attribute(const std::string& object, const std::string& name,
                              const std::vector<std::string>& texts) {
  const Quiet quiet;
  const auto type = text_type();
  std::vector<const char*> characters;
  for (const std::string& text : texts) characters.push_back(text.c_str());
  write_attribute(object, name, type.id(), Hdf5Dims{texts.size()}, characters.data());
}

void Hdf5File::fixed_text_attribute(const std::string& object, const std::string& name, const std::string& text) {
  const Quiet quiet;
  const auto type = checked(H5Tcopy(H5T_C_S1), H5Tclose, "describe", object);
  check(H5Tset_size(type.id(), text.size()), "describe", object);
  check(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), "describe", object);
  write_attribute(object, name, type.id(), std::nullopt, text.data());
}

template void Hdf5File::create_dataset<double>(const std::string&, const Hdf5Dims&);
template void Hdf5File::create_dataset<std::int32_t>(const std::string&, const Hdf5Dims&);
template void Hdf5File::create_dataset<std::int64_t>(const std::string&, const Hdf5Dims&);
template void Hdf5File::create_growing_dataset<float>(const std::string&, const Hdf5Dims&, const Hdf5Dims&);
template void Hdf5File::create_growing_dataset<double>(const std::string&, const Hdf5Dims&, const Hdf5Dims&);
template void Hdf5File::create_growing_dataset<std::uint8_t>(const std::string&, const Hdf5Dims&, const Hdf5Dims&);
template void Hdf5File::create_growing_dataset<std::int32_t>(const std::string&, const Hdf5Dims&, const Hdf5Dims&);
template void Hdf5File::create_growing_dataset<std::int64_t>(const std::string&, const Hdf5Dims&, const Hdf5Dims&);
template void Hdf5File::append_row<float>(const std::string&, std::span<const float>);
template void Hdf5File::append_row<double>(const std::string&, std::span<const double>);
template void Hdf5File::append_row<std::uint8_t>(const std::string&, std::span<const std::uint8_t>);
template void Hdf5File::append_row<std::int32_t>(const std::string&, std::span<const std::int32_t>);
template void Hdf5File::append_row<std::int64_t>(const std::string&, std::span<const std::int64_t>);
template void Hdf5File::create_chunked_dataset<float>(const std::string&, const Hdf5Dims&, const Hdf5Dims&, float);
template void Hdf5File::create_chunked_dataset<std::uint32_t>(const std::string&, const Hdf5Dims&, const Hdf5Dims&,
                                                              std::uint32_t);
template void Hdf5File::write<double>(const std::string&, std::span<const double>);
template void Hdf5File::write<std::int32_t>(const std::string&, std::span<const std::int32_t>);
template void Hdf5File::write<std::int64_t>(const std::string&, std::span<const std::int64_t>);
template void Hdf5File::write_chunk<float>(const std::string&, const Hdf5Dims&, std::span<const float>);
template void Hdf5File::write_chunk<std::uint32_t>(const std::string&, const Hdf5Dims&, std::span<const std::uint32_t>);
template void Hdf5File::attribute<double>(const std::string&, const std::string&, std::span<const double>);
template void Hdf5File::attribute<std::int32_t>(const std::string&, const std::string&, std::span<const std::int32_t>);
template void Hdf5File::attribute<std::int64_t>(const std::string&, const std::string&, std::span<const std::int64_t>);
template void Hdf5File::attribute<std::uint32_t>(const std::string&, const std::string&,
                                                 std::span<const std::uint32_t>);
template void Hdf5File::attribute<std::uint8_t>(const std::string&, const std::string&, std::span<const std::uint8_t>);
template void Hdf5File::attribute<float>(const std::string&, const std::string&, float);
template void Hdf5File::attribute<double>(const std::string&, const std::string&, double);
template void Hdf5File::attribute<std::int64_t>(const std::string&, const std::string&, std::int64_t);

}  // namespace grainvdb
