#pragma once
/// DIR/tracers.h5: the histories of tracers in H5MD 1.1 layout, and DIR/tracers.xmf2 beside it for ParaView.
///
///   /h5md                              version, and author and creator
///   /particles/tracers/box             dimension, boundary, offset (the lower corner), edges over time
///   /particles/tracers/position        value (T,N,3) float64, wrapped into the box; step (T), time (T)
///   /particles/tracers/image           value (T,N,3) int32: unwrapped = position + image × edges
///   /particles/tracers/id              (N) int64
///   /particles/tracers/<field>         value (T,N[,C]) float32, for every recorded field
///   /particles/tracers/displacement    value (T,N,3) float64; strain, courant, gradient_number (T,N) where recorded
///   /particles/tracers/stop            value (T,N) uint8, named by flag_values and flag_meanings
///   /particles/tracers/stop_time       (N) float64: until when a tracer could be followed; NaN where it still moves
///   /observables/<name>                the fields, displacement, … once more (the same objects): what MDAnalysis
///   offers as ts.data /provenance/<key>                  one text each
///
/// All of them share one step and one time. Datasets have `units` and `long_name`; H5MD's own `unit` is not used, as
/// MDAnalysis accepts only the units of molecular dynamics there. Samples go to the file as they come. Memory: 8 bytes
/// per sample, 1 MiB per dataset, and 24 bytes per tracer, besides the sample itself.
#include <memory>
#include <string>

#include "grainvdb/tracer_sink.hpp"

namespace grainvdb {

std::unique_ptr<TracerSink> make_h5md_sink(const std::string& directory);

}  // namespace grainvdb
