#include "grainvdb/followed_input.hpp"

#include <cstdint>
#include <map>
#include <utility>

#include "grainvdb/error.hpp"
#include "read/dump_directory.hpp"
#include "read/file_list.hpp"

namespace grainvdb {
namespace {

/// What tells whether a file has changed.
struct Look {
  std::uintmax_t size = 0;
  std::int64_t changed = 0;
  bool whole = false;
};

}  // namespace

struct FollowedInput::Seen {
  InputSpec spec;
  std::map<FileIdentity, Look> files;

  void judge(InputFiles& now) {
    std::map<FileIdentity, InputFile::State> judged;  // a file may hold contacts of both sorts
    for (std::vector<InputFile>* list : {&now.particles, &now.contacts, &now.wall_contacts})
      for (InputFile& file : *list) {
        const auto [state, is_new] = judged.try_emplace(file.identity);
        if (is_new) state->second = judge(file);
        file.state = state->second;
      }
  }

 private:
  InputFile::State judge(const InputFile& file) {
    Look& before = files[file.identity];
    if (before.size != file.size || before.changed != file.changed) {
      before = {file.size, file.changed, false};
      return InputFile::State::growing;
    }
    return before.whole ? InputFile::State::known : InputFile::State::settled;
  }
};

FollowedInput::FollowedInput(InputSpec spec) : seen_(std::make_unique<Seen>()) {
  check_spec(spec);
  seen_->spec = std::move(spec);
}

FollowedInput::~FollowedInput() = default;

const InputSpec& FollowedInput::spec() const {
  return seen_->spec;
}

std::unique_ptr<FrameSource> FollowedInput::look(std::optional<std::int64_t> last_step) {
  std::unique_ptr<DumpDirectory> dumps;
  try {
    InputFiles files = find_files(seen_->spec);
    seen_->judge(files);
    dumps = std::make_unique<DumpDirectory>(seen_->spec, std::move(files));
    dumps->keep_frames_with_contacts();
    if (last_step) dumps->keep_frames_up_to(*last_step);
    for (const FileIdentity& file : dumps->whole_files()) seen_->files[file].whole = true;
  } catch (const InputError&) {
    return nullptr;  // nothing that could be used has come
  } catch (const IoError&) {
    return nullptr;  // a file was renamed or removed while it was looked at
  }
  dumps->require_no_fault();
  if (dumps->frames().empty()) return nullptr;
  return dumps;
}

}  // namespace grainvdb
