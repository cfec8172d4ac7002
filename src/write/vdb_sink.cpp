#include "write/vdb_sink.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "grainvdb/error.hpp"
#include "write/atomic_file.hpp"
#include "write/vdb_file.hpp"
#include "write/vdb_grids.hpp"

namespace grainvdb {
namespace {

namespace fs = std::filesystem;
using openvdb::MetaMap;
using openvdb::StringMetadata;

MetaMap time_metadata(const OutputTime& time, const OutputLayout& layout) {
  MetaMap all;
  all.insertMeta("time", openvdb::DoubleMetadata(time.time));
  all.insertMeta("time_unit", StringMetadata(layout.time_unit));
  all.insertMeta("length_unit", StringMetadata(layout.length_unit));
  all.insertMeta("first_step", openvdb::Int64Metadata(time.first_step));
  all.insertMeta("last_step", openvdb::Int64Metadata(time.last_step));
  all.insertMeta("frame_count", openvdb::Int64Metadata(static_cast<std::int64_t>(time.frame_count)));
  return all;
}

/// Whether a file name is one that this sink gives: fields.vdb, or fields_ and at least four digits.
bool is_our_name(const std::string& name) {
  if (name == "fields.vdb") return true;
  if (!name.starts_with("fields_") || !name.ends_with(".vdb")) return false;
  const std::string digits = name.substr(7, name.size() - 11);
  return digits.size() >= 4 &&
         std::all_of(digits.begin(), digits.end(), [](unsigned char c) { return std::isdigit(c); });
}

class VdbSink final : public FieldSink {
 public:
  explicit VdbSink(std::string directory) : directory_(std::move(directory)) {}

  void begin(const OutputLayout& layout) override;
  void write(const OutputTime& time, const std::vector<const SparseField*>& fields, const Mask* mask) override;
  void commit(const Provenance& provenance) override;
  std::vector<std::string> files() const override;

 private:
  std::string path(std::size_t step) const;
  void remove_outdated() const;

  fs::path directory_;
  std::optional<OutputLayout> layout_;
  std::vector<std::unique_ptr<AtomicFile>> drafts_;  ///< per output time, complete but for the provenance
};

std::string VdbSink::path(std::size_t step) const {
  if (layout_->time_count == 1) return (directory_ / "fields.vdb").string();
  const std::string number = std::to_string(step);
  const std::size_t width = std::max<std::size_t>(4, std::to_string(layout_->time_count - 1).size());
  return (directory_ / ("fields_" + std::string(width - number.size(), '0') + number + ".vdb")).string();
}

void VdbSink::begin(const OutputLayout& layout) {
  if (layout_) throw std::logic_error("an output can begin only once");
  if (layout.time_count == 0) throw std::invalid_argument("an output needs at least one time");
  initialize_openvdb();
  layout_ = layout;
  const AtomicFile probe(path(0));  // a folder that cannot be written to shows before the work, not after it
}

void VdbSink::write(const OutputTime& time, const std::vector<const SparseField*>& fields, const Mask* mask) {
  if (!layout_ || drafts_.size() == layout_->time_count)
    throw std::logic_error("an output time that was not announced");
  const MetaMap metadata = time_metadata(time, *layout_);
  openvdb::GridCPtrVec grids;
  for (const SparseField* field : fields)
    for (const auto& grid : make_grids(*field, metadata)) grids.push_back(grid);
  if (mask != nullptr) grids.push_back(make_mask_grid(*mask, layout_->lattice, metadata));
  auto draft = std::make_unique<AtomicFile>(path(drafts_.size()));
  write_vdb(*draft, grids, {});
  draft->finish();
  drafts_.push_back(std::move(draft));
}

void VdbSink::commit(const Provenance& provenance) {
  if (!layout_ || drafts_.size() != layout_->time_count)
    throw std::logic_error("an output was committed before its end");
  MetaMap metadata;
  for (const auto& [key, text] : provenance) metadata.insertMeta("provenance/" + key, StringMetadata(text));

  // File metadata stand at the head of a VDB file and are complete only now, so each draft is copied behind them.
  std::vector<std::unique_ptr<AtomicFile>> results;
  for (auto& draft : drafts_) {
    const openvdb::GridPtrVecPtr grids = read_vdb(*draft);
    for (const auto& grid : *grids) clear_inactive(*grid);
    results.push_back(std::make_unique<AtomicFile>(draft->path()));
    write_vdb(*results.back(), {grids->begin(), grids->end()}, metadata);
    results.back()->finish();
    draft.reset();
  }
  for (const auto& result : results) result->publish();
  remove_outdated();
}

void VdbSink::remove_outdated() const {
  const std::vector<std::string> current = files();
  std::error_code error;
  std::vector<std::string> outdated;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory_, error))
    if (is_our_name(entry.path().filename().string()) &&
        std::find(current.begin(), current.end(), entry.path().string()) == current.end())
      outdated.push_back(entry.path().string());
  if (error) throw IoError("cannot list the folder", directory_.string(), error.value());
  for (const std::string& file : outdated) remove_file(file);
}

std::vector<std::string> VdbSink::files() const {
  std::vector<std::string> all;
  for (std::size_t step = 0; layout_ && step < layout_->time_count; ++step) all.push_back(path(step));
  return all;
}

}  // namespace

std::unique_ptr<FieldSink> make_vdb_sink(const std::string& directory) {
  return std::make_unique<VdbSink>(directory);
}

}  // namespace grainvdb
