#pragma once
/// The frames of a run: particle dumps and, on demand, the contact dumps of the same timesteps.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "grainvdb/frame_source.hpp"
#include "read/dump_series.hpp"
#include "read/file_list.hpp"

namespace grainvdb {

/// The files that the input names, found without opening any.
struct InputFiles {
  std::vector<InputFile> particles, contacts, wall_contacts;
};

/// Throws ConfigError where the specification itself cannot be meant.
void check_spec(const InputSpec& spec);

InputFiles find_files(const InputSpec& spec);

class DumpDirectory final : public FrameSource {
 public:
  DumpDirectory(const InputSpec& spec, InputFiles files);

  const std::vector<FrameInfo>& frames() const override { return frames_; }
  const UnitSystem& units() const override { return units_; }
  const std::vector<std::string>& particle_columns() const override {
    return particles_.columns(particles_.frames().front());
  }
  std::vector<std::string> contact_columns() override { return contacts_->first_columns(); }
  std::vector<std::string> wall_contact_columns() override { return wall_contacts_->first_columns(); }
  std::vector<std::pair<std::string, std::uintmax_t>> files() const override;
  void require(std::size_t k, ColumnSet wanted) override;
  Frame read(std::size_t k, ColumnSet wanted) override;
  std::vector<BadFrame> unreadable() const override;
  const ReadCounters& counters() const override { return counters_; }

  /// Leaves out frames from the first on that lacks contacts of a kind, where there are dumps of that kind.
  void keep_frames_with_contacts();
  void keep_frames_up_to(std::int64_t step);
  /// Files that settled and were found complete.
  std::vector<FileIdentity> whole_files() const;
  /// Throws what is wrong with a file that will not be completed any more, although it may still be written to.
  void require_no_fault() const;

 private:
  /// Dumps beside those of the particles, and how messages call what they hold.
  struct Beside {
    DumpSeries& series;
    const std::vector<std::string>& patterns;
    std::string section;
    std::string noun;
  };
  Beside contacts() { return {*contacts_, spec_.contacts.files, "input.contacts", "contact"}; }
  Beside wall_contacts() { return {*wall_contacts_, spec_.wall_contacts.files, "input.wall_contacts", "wall contact"}; }
  std::size_t find_beside(std::size_t frame, const Beside& dumps);
  Contacts read_contacts(std::size_t frame);
  WallContacts read_wall_contacts(std::size_t frame, const std::vector<std::int64_t>& ids);

  InputSpec spec_;
  ReadCounters counters_;
  DumpSeries particles_;
  // Made in the constructor, once it is known which files hold particles.
  std::optional<DumpSeries> contacts_, wall_contacts_;
  UnitSystem units_;
  std::vector<FrameInfo> frames_;
};

}  // namespace grainvdb
