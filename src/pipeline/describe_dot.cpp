#include <set>
#include <string>

#include "grainvdb/plan.hpp"

namespace grainvdb {
namespace {

std::string quote(const std::string& text) {
  std::string result = "\"";
  for (char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

std::string edge(const std::string& from, const std::string& to, const std::string& style = {}) {
  return "  " + quote(from) + " -> " + quote(to) + (style.empty() ? "" : " [" + style + ']') + ";\n";
}

}  // namespace

std::string describe_dot(const Plan& plan, const Pipeline& pipeline) {
  std::string nodes, edges;
  std::set<std::string> seen;
  const auto node = [&](const std::string& id, const std::string& label, const std::string& style) {
    if (seen.insert(id).second) nodes += "  " + quote(id) + " [label=" + quote(label) + ", " + style + "];\n";
  };
  for (const Sweep& sweep : plan.sweeps)
    for (const auto& pass : sweep.passes)
      for (const MomentPtr& moment : pass) {
        const std::string id = "moment:" + moment->name;
        if (seen.contains(id)) continue;  // computed again in a later sweep
        node(id, moment->name, "shape=box");
        for (const std::string& column : column_names(moment->columns)) {
          node("column:" + column, column, "shape=plaintext");
          edges += edge("column:" + column, id);
        }
        for (const MomentPtr& need : moment->frame_needs) edges += edge("moment:" + need->name, id);
        for (const MomentPtr& need : moment->mean_needs)
          edges += edge("moment:" + need->name, id, "style=dashed, label=\"time mean\"");
      }
  for (const Stage* stage : plan.stages) {
    node("field:" + stage->name, stage->name, "shape=ellipse");
    const StageNeeds needs = stage->needs ? stage->needs(pipeline.stages) : StageNeeds{};
    for (const MomentPtr& moment : needs.moments) edges += edge("moment:" + moment->name, "field:" + stage->name);
    for (const std::string& field : needs.fields) edges += edge("field:" + field, "field:" + stage->name);
  }
  for (const std::string& field : pipeline.fields) {
    node("output", "output", "shape=folder");
    edges += edge("field:" + field, "output");
  }
  if (pipeline.trace) {
    node("tracers", "tracers", "shape=folder");
    Pipeline traced = pipeline;
    traced.fields.clear();
    for (const std::string& field : computed_fields(traced)) edges += edge("field:" + field, "tracers");
  }
  return "digraph grainvdb {\n  rankdir=LR;\n" + nodes + edges + "}\n";
}

}  // namespace grainvdb
