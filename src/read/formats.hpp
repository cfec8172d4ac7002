#pragma once
/// The dump formats that can be read, told from the content of a file. A format is one class derived from DumpFile and
/// one line in dump_formats().
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "grainvdb/frame_source.hpp"
#include "read/byte_stream.hpp"
#include "read/dump_file.hpp"

namespace grainvdb {

struct DumpFormat {
  std::string_view name;
  bool (*recognise)(std::string_view head);  ///< from the first bytes of the (decompressed) file
  std::unique_ptr<DumpFile> (*open)(std::unique_ptr<ByteStream> bytes, const std::string& file);
};

/// In the order in which they are tried.
const std::vector<DumpFormat>& dump_formats();

struct OpenedDump {
  std::unique_ptr<DumpFile> dump;  ///< null when the format is not recognised
  Compression compression = Compression::none;
  std::string head;  ///< the first bytes, which tell what else it is
};

/// Opens a file and recognises its format. Notes the file in the counters, which must outlive the result.
OpenedDump open_dump(const std::string& path, ReadCounters& counters);

/// Throws the InputError for a file whose format is not recognised: what it looks like, and what is supported.
[[noreturn]] void refuse_unrecognised(const std::string& path, const OpenedDump& file);

}  // namespace grainvdb
