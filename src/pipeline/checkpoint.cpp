#include "pipeline/checkpoint.hpp"

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "grainvdb/error.hpp"
#include "pipeline/saved_fields.hpp"
#include "write/checked_file.hpp"

namespace grainvdb {
namespace {

namespace fs = std::filesystem;

constexpr const char* state_name = "state";

std::string output_name(std::size_t k) {
  return "output" + std::to_string(k);
}

RunKey read_key(ByteReader& from) {
  RunKey key;
  for (std::size_t left = from.count(); left > 0; --left) {
    std::string name = from.text();
    key.emplace_back(std::move(name), from.text());
  }
  return key;
}

void write_key(ByteWriter& to, const RunKey& key) {
  to.number(std::uint64_t{key.size()});
  for (const auto& [name, text] : key) {
    to.text(name);
    to.text(text);
  }
}

/// The first line in which two texts differ.
std::string first_difference(const std::string& text, const std::string& other) {
  std::size_t begin = 0, k = 0;
  for (; k < text.size() && k < other.size() && text[k] == other[k]; ++k)
    if (text[k] == '\n') begin = k + 1;
  return text.substr(begin, text.find('\n', k) - begin);
}

}  // namespace

Checkpoint::Checkpoint(double interval, std::string folder, RunKey key)
    : interval_(interval), folder_(std::move(folder)), key_(std::move(key)) {
  lock();
  try {
    remove_leftovers(folder_);
    has_state_ = fs::exists(path(state_name));
  } catch (...) {
    ::close(lock_);
    throw;
  }
}

Checkpoint::Checkpoint(const CheckpointOptions& options, RunKey key)
    : Checkpoint(options.interval, (fs::path(options.output_folder) / ".grainvdb-checkpoint").string(),
                 std::move(key)) {
  remove_leftovers(options.output_folder);
  const fs::path tables = fs::path(options.output_folder) / "tables";
  if (fs::is_directory(tables)) remove_leftovers(tables.string());
  if (has_state_) check_key();
}

Checkpoint::~Checkpoint() {
  ::close(lock_);
}

std::string Checkpoint::path(const std::string& name) const {
  return (fs::path(folder_) / name).string();
}

/// The lock goes with the process, however it ends.
void Checkpoint::lock() {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw IoError("cannot create the folder", folder_, error.value());
  lock_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0) throw IoError("cannot open the folder", folder_, errno);
  if (::flock(lock_, LOCK_EX | LOCK_NB) == 0) return;
  const int reason = errno;
  ::close(lock_);
  if (reason == EWOULDBLOCK) throw IoError("another run is at work in the folder", folder_, 0);
  throw IoError("cannot lock the folder", folder_, reason);
}

void Checkpoint::check_key() const {
  CheckedFileReader file(path(state_name));
  const RunKey found = read_key(file);
  for (const auto& [name, text] : key_)
    for (const auto& [other_name, other] : found)
      if (name == other_name && text != other)
        throw ConfigError({{folder_, 0},
                           "the run that was interrupted here had another " + name,
                           first_difference(other, text),
                           first_difference(text, other),
                           "Run it with what it had, choose another output folder, or remove this one to begin anew"});
}

void Checkpoint::load_state(const std::function<void(ByteReader&)>& load) const {
  CheckedFileReader file(path(state_name));
  read_key(file);
  load(file);
}

void Checkpoint::note_resumed(std::size_t frames) {
  if (!resumed_at_) resumed_at_ = frames;
}

bool Checkpoint::is_due() const {
  return std::chrono::steady_clock::now() - saved_ >= std::chrono::duration<double>(interval_);
}

void Checkpoint::save_state(const std::function<void(ByteWriter&)>& save) {
  CheckedFileWriter file(path(state_name));
  write_key(file, key_);
  save(file);
  file.publish();
  saved_ = std::chrono::steady_clock::now();
  if (!has_state_) resumed_at_ = 0;
  has_state_ = true;
}

void Checkpoint::save_output(std::size_t k, const OutputFields& output) const {
  CheckedFileWriter file(path(output_name(k)));
  grainvdb::save_output(file, output);
  file.publish();
}

OutputFields Checkpoint::load_output(std::size_t k, const Lattice& lattice) const {
  CheckedFileReader file(path(output_name(k)));
  return grainvdb::load_output(file, lattice);
}

std::unique_ptr<Checkpoint> Checkpoint::of_pass(const std::string& name, RunKey key) const {
  std::unique_ptr<Checkpoint> pass(new Checkpoint(interval_, path(name), std::move(key)));
  if (!pass->has_state_) return pass;
  CheckedFileReader file(pass->path(state_name));
  if (read_key(file) == pass->key_) return pass;
  remove_file(pass->path(state_name));
  pass->has_state_ = false;
  return pass;
}

void Checkpoint::remove() {
  // Without its state a checkpoint counts for nothing, whatever else is left of it.
  remove_file(path(state_name));
  std::error_code error;
  fs::remove_all(folder_, error);
  if (error) throw IoError("cannot remove the folder", folder_, error.value());
}

}  // namespace grainvdb
