#pragma once
/// Where a run stands, kept in a folder so that another run can go on from there.
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/bytes.hpp"
#include "grainvdb/run.hpp"

namespace grainvdb {

/// What a run must have in common with the one that it continues: name → text.
using RunKey = std::vector<std::pair<std::string, std::string>>;

/// The folder holds the output times that are finished, a file each, and the state of the run, which says how many of
/// them count. Files appear under their names when they are complete and on the disk, so that whatever ends the run
/// leaves a state that can be continued.
class Checkpoint {
 public:
  /// Makes the folder, and keeps other runs out of it. Throws ConfigError where it is that of a run with another key,
  /// InputError where a file in it is damaged, IoError.
  Checkpoint(const CheckpointOptions& options, RunKey key);
  ~Checkpoint();
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  /// Whether there is a state: that of an earlier run, or one that was saved since.
  bool has_state() const { return has_state_; }
  void load_state(const std::function<void(ByteReader&)>& load) const;
  /// How many frames an earlier run had done, as its state says; what this run saved itself does not count.
  void note_resumed(std::size_t frames);
  std::size_t resumed_at() const { return resumed_at_.value_or(0); }
  /// Whether it is time to save it again.
  bool is_due() const;
  void save_state(const std::function<void(ByteWriter&)>& save);

  void save_output(std::size_t k, const OutputFields& output) const;
  OutputFields load_output(std::size_t k, const Lattice& lattice) const;

  /// That of a pass which the run makes behind this one, in a folder within: it goes when this one is removed. A state
  /// that was saved with another key is dropped.
  std::unique_ptr<Checkpoint> of_pass(const std::string& name, RunKey key) const;

  /// Once the results are complete.
  void remove();

 private:
  Checkpoint(double interval, std::string folder, RunKey key);
  std::string path(const std::string& name) const;
  void lock();
  void check_key() const;

  double interval_;
  std::string folder_;
  RunKey key_;
  int lock_ = -1;
  bool has_state_ = false;
  std::optional<std::size_t> resumed_at_;  // 0 where there was nothing to resume
  std::chrono::steady_clock::time_point saved_ = std::chrono::steady_clock::now();
};

}  // namespace grainvdb
