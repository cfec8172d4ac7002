#include "write/tracer_sidecar.hpp"

#include "write/xdmf_text.hpp"

namespace grainvdb {

void write_tracer_sidecar(AtomicFile& file, const std::string& data_file, std::uint64_t tracers,
                          std::span<const double> times, const TracerDataset& position, const TracerDataset& id,
                          std::span<const TracerDataset> others) {
  std::uint64_t end = 0;
  const auto append = [&](const std::string& text) {
    file.write(end, text);
    end += text.size();
  };
  append(
      "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"2.0\">\n<Domain>\n"
      "<Grid Name=\"tracers\" GridType=\"Collection\" CollectionType=\"Temporal\">\n");
  for (std::size_t step = 0; step < times.size(); ++step) {
    const auto at_step = [&](const TracerDataset& set) {
      return XdmfDataset{set.name,    data_file + ':' + set.path, set.number, set.components, {tracers}, step,
                         times.size()};
    };
    std::string text = "<Grid Name=\"points\" GridType=\"Uniform\">\n<Time Value=\"" + xdmf_number(times[step]) +
                       "\"/>\n<Topology TopologyType=\"Polyvertex\" NumberOfElements=\"" + std::to_string(tracers) +
                       "\" NodesPerElement=\"1\"/>\n<Geometry GeometryType=\"XYZ\">\n" +
                       xdmf_values(at_step(position)) + "</Geometry>\n";
    XdmfDataset ids = at_step(id);
    ids.step.reset();  // they are the same at all times
    text += xdmf_attribute(ids);
    for (const TracerDataset& set : others) text += xdmf_attribute(at_step(set));
    append(text + "</Grid>\n");
  }
  append("</Grid>\n</Domain>\n</Xdmf>\n");
}

}  // namespace grainvdb
