#include "pipeline/option_keys.hpp"

#include <stdexcept>
#include <type_traits>
#include <utility>
#include <variant>

namespace grainvdb {
namespace {

ValueType type_of(const OptionValue& value) {
  static constexpr ValueType types[] = {ValueType::boolean, ValueType::integer, ValueType::number,
                                        ValueType::text,    ValueType::texts,   ValueType::numbers};
  return types[value.index()];
}

template <class T, class Variant>
struct IsAlternative;
template <class T, class... Alternatives>
struct IsAlternative<T, std::variant<Alternatives...>> : std::disjunction<std::is_same<T, Alternatives>...> {};

/// Values of other types are those of keys that are no options.
OptionValue option_value(const ConfigValue& value) {
  return std::visit(
      []<class T>(const T& v) -> OptionValue {
        if constexpr (IsAlternative<T, OptionValue>()) return v;
        throw std::logic_error("an option of a type that options do not have");
      },
      value);
}

}  // namespace

KeyInfo option_key(const std::string& section, const OptionInfo& option,
                   std::function<OptionValues&(Pipeline&)> options_of) {
  KeyInfo key{section, option.name, type_of(option.default_value), option.help};
  key.default_value = std::visit([](const auto& v) { return ConfigValue(v); }, option.default_value);
  key.choices = option.choices;
  key.minimum = option.minimum;
  key.maximum = option.maximum;
  key.fewest = 0;
  key.apply = [options_of = std::move(options_of), name = option.name](Pipeline& p, const ConfigValue& v) {
    options_of(p)[name] = option_value(v);
  };
  return key;
}

}  // namespace grainvdb
