#include "write/hdf5_storage.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <limits>
#include <new>

#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif

namespace grainvdb {
namespace {

/// What the property list carries; HDF5 copies it byte by byte.
struct DriverInfo {
  Hdf5Storage* storage;
};

/// HDF5's open file. `common` comes first, so that a pointer to it is one to the whole.
struct OpenFile {
  H5FD_t common;
  Hdf5Storage* storage;
  haddr_t end_of_allocation;
  haddr_t end_of_file;
};

OpenFile& self(H5FD_t* file) {
  return *reinterpret_cast<OpenFile*>(file);
}
const OpenFile& self(const H5FD_t* file) {
  return *reinterpret_cast<const OpenFile*>(file);
}

H5FD_t* open_file(const char*, unsigned flags, hid_t properties, haddr_t) {
  const auto* info = static_cast<const DriverInfo*>(H5Pget_driver_info(properties));
  if (info == nullptr) return nullptr;
  auto* file = new (std::nothrow) OpenFile{};
  if (file == nullptr) return nullptr;
  file->storage = info->storage;
  if ((flags & H5F_ACC_TRUNC) != 0) file->storage->resize(0);
  return &file->common;
}

herr_t close_file(H5FD_t* file) {
  delete &self(file);
  return 0;
}

int compare(const H5FD_t* a, const H5FD_t* b) {
  const std::less<const Hdf5Storage*> before;
  if (before(self(a).storage, self(b).storage)) return -1;
  return before(self(b).storage, self(a).storage) ? 1 : 0;
}

herr_t query(const H5FD_t*, unsigned long* features) {
  *features = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
              H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

haddr_t end_of_allocation(const H5FD_t* file, H5FD_mem_t) {
  return self(file).end_of_allocation;
}

herr_t set_end_of_allocation(H5FD_t* file, H5FD_mem_t, haddr_t address) {
  self(file).end_of_allocation = address;
  return 0;
}

haddr_t end_of_file(const H5FD_t* file, H5FD_mem_t) {
  return self(file).end_of_file;
}

herr_t read(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, void* buffer) {
  return self(file).storage->read(address, {static_cast<std::byte*>(buffer), size}) ? 0 : -1;
}

herr_t write(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, const void* buffer) {
  OpenFile& f = self(file);
  f.storage->write(address, {static_cast<const std::byte*>(buffer), size});
  f.end_of_file = std::max(f.end_of_file, address + size);
  return 0;
}

herr_t truncate(H5FD_t* file, hid_t, hbool_t) {
  OpenFile& f = self(file);
  if (f.end_of_file == f.end_of_allocation) return 0;
  f.storage->resize(f.end_of_allocation);
  f.end_of_file = f.end_of_allocation;
  return 0;
}

H5FD_class_t make_driver() {
  H5FD_class_t driver{};
#if H5_VERSION_GE(1, 13, 0)
  driver.version = H5FD_CLASS_VERSION;
  driver.value = static_cast<H5FD_class_value_t>(511);  // of the range left to unregistered drivers
#endif
  driver.name = "grainvdb";
  driver.maxaddr = static_cast<haddr_t>(std::numeric_limits<std::int64_t>::max());
  driver.fc_degree = H5F_CLOSE_STRONG;
  driver.fapl_size = sizeof(DriverInfo);
  driver.open = open_file;
  driver.close = close_file;
  driver.cmp = compare;
  driver.query = query;
  driver.get_eoa = end_of_allocation;
  driver.set_eoa = set_end_of_allocation;
  driver.get_eof = end_of_file;
  driver.read = read;
  driver.write = write;
  driver.truncate = truncate;
  const H5FD_mem_t free_lists[] = H5FD_FLMAP_DICHOTOMY;  // as HDF5's default driver
  std::copy(std::begin(free_lists), std::end(free_lists), driver.fl_map);
  return driver;
}

hid_t registered_driver() {
  static const H5FD_class_t driver = make_driver();
  static const hid_t id = H5FDregister(&driver);
  return id;
}

}  // namespace

hid_t Hdf5Storage::access_properties() {
  const hid_t driver = registered_driver();
  const hid_t properties = H5Pcreate(H5P_FILE_ACCESS);
  if (driver < 0 || properties < 0) return -1;
  const DriverInfo info{this};
  if (H5Pset_driver(properties, driver, &info) >= 0) return properties;
  H5Pclose(properties);
  return -1;
}

template <class Action>
bool Hdf5Storage::attempt(Action&& action) noexcept {
  try {
    action();
    return true;
  } catch (...) {
    if (!failure_) failure_ = std::current_exception();
    discarded_ = true;
    return false;
  }
}

void Hdf5Storage::write(std::uint64_t offset, std::span<const std::byte> bytes) noexcept {
  if (!discarded_) attempt([&] { file_.write(offset, bytes); });
}

bool Hdf5Storage::read(std::uint64_t offset, std::span<std::byte> bytes) noexcept {
  return attempt([&] { file_.read(offset, bytes); });
}

void Hdf5Storage::resize(std::uint64_t size) noexcept {
  if (!discarded_) attempt([&] { file_.resize(size); });
}

void Hdf5Storage::rethrow_failure() const {
  if (failure_) std::rethrow_exception(failure_);
}

}  // namespace grainvdb
