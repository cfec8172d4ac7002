#pragma once
/// How units are written that are made of others.
#include <cstdlib>
#include <string>

namespace grainvdb {

/// "kg/(m s^2)"; "1" for the empty product.
class UnitProduct {
 public:
  void multiply(const std::string& unit, int power) {
    if (power == 0) return;
    std::string& to = power > 0 ? above_ : below_;
    if (power < 0) ++below_count_;
    if (!to.empty()) to += ' ';
    to += unit;
    if (std::abs(power) > 1) to += '^' + std::to_string(std::abs(power));
  }

  std::string text() const {
    std::string text = above_;
    if (text.empty()) text.push_back('1');
    if (below_.empty()) return text;
    return text + '/' + (below_count_ > 1 ? '(' + below_ + ')' : below_);
  }

 private:
  std::string above_, below_;
  int below_count_ = 0;
};

}  // namespace grainvdb
