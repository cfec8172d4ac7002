#include "grainvdb/line_rule.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace grainvdb {
namespace {

constexpr std::array<LineNode, 1> gauss_1{{{0, 2}}};
constexpr std::array<LineNode, 2> gauss_2{{{-0.57735026918962576451, 1}, {0.57735026918962576451, 1}}};
constexpr std::array<LineNode, 3> gauss_3{{{-0.77459666924148337704, 0.55555555555555555556},
                                           {0, 0.88888888888888888889},
                                           {0.77459666924148337704, 0.55555555555555555556}}};
constexpr std::array<LineNode, 4> gauss_4{{{-0.86113631159405257522, 0.34785484513745385737},
                                           {-0.33998104358485626480, 0.65214515486254614263},
                                           {0.33998104358485626480, 0.65214515486254614263},
                                           {0.86113631159405257522, 0.34785484513745385737}}};
constexpr std::array<LineNode, 5> gauss_5{{{-0.90617984593866399280, 0.23692688505618908751},
                                           {-0.53846931010568309104, 0.47862867049936646804},
                                           {0, 0.56888888888888888889},
                                           {0.53846931010568309104, 0.47862867049936646804},
                                           {0.90617984593866399280, 0.23692688505618908751}}};
constexpr std::array<LineNode, 6> gauss_6{{{-0.93246951420315202781, 0.17132449237917034504},
                                           {-0.66120938646626451366, 0.36076157304813860757},
                                           {-0.23861918608319690863, 0.46791393457269104739},
                                           {0.23861918608319690863, 0.46791393457269104739},
                                           {0.66120938646626451366, 0.36076157304813860757},
                                           {0.93246951420315202781, 0.17132449237917034504}}};
constexpr std::array<LineNode, 7> gauss_7{{{-0.94910791234275852453, 0.12948496616886969327},
                                           {-0.74153118559939443986, 0.27970539148927666790},
                                           {-0.40584515137739716691, 0.38183005050511894495},
                                           {0, 0.41795918367346938776},
                                           {0.40584515137739716691, 0.38183005050511894495},
                                           {0.74153118559939443986, 0.27970539148927666790},
                                           {0.94910791234275852453, 0.12948496616886969327}}};
constexpr std::array<LineNode, 8> gauss_8{{{-0.96028985649753623168, 0.10122853629037625915},
                                           {-0.79666647741362673959, 0.22238103445337447054},
                                           {-0.52553240991632898582, 0.31370664587788728734},
                                           {-0.18343464249564980494, 0.36268378337836198297},
                                           {0.18343464249564980494, 0.36268378337836198297},
                                           {0.52553240991632898582, 0.31370664587788728734},
                                           {0.79666647741362673959, 0.22238103445337447054},
                                           {0.96028985649753623168, 0.10122853629037625915}}};

// Minimax over the distance of the line from the centre and the place of the branch along it, by random descent from
// the Gauss-Legendre rules, for branches of the length below.
constexpr std::array<LineNode, 2> lucy_2{{{-0.5755166448, 1}, {0.5755166448, 1}}};
constexpr std::array<LineNode, 3> lucy_3{{{-0.7467617836, 0.596665996}, {0, 0.806668008}, {0.7467617836, 0.596665996}}};
constexpr std::array<LineNode, 4> lucy_4{{{-0.8655485861, 0.348172548},
                                          {-0.3341133221, 0.651827452},
                                          {0.3341133221, 0.651827452},
                                          {0.8655485861, 0.348172548}}};
constexpr std::array<LineNode, 5> lucy_5{{{-0.9049744126, 0.2359264242},
                                          {-0.5376106629, 0.4843373072},
                                          {0, 0.5594725372},
                                          {0.5376106629, 0.4843373072},
                                          {0.9049744126, 0.2359264242}}};
constexpr std::array<LineNode, 6> lucy_6{{{-0.9337823782, 0.170428933},
                                          {-0.6621753609, 0.3613776272},
                                          {-0.2372765833, 0.4681934398},
                                          {0.2372765833, 0.4681934398},
                                          {0.6621753609, 0.3613776272},
                                          {0.9337823782, 0.170428933}}};
constexpr std::array<LineNode, 7> lucy_7{{{-0.9486363195, 0.1287742692},
                                          {-0.7418116208, 0.2809567046},
                                          {-0.4047245983, 0.3833104176},
                                          {0, 0.4139172172},
                                          {0.4047245983, 0.3833104176},
                                          {0.7418116208, 0.2809567046},
                                          {0.9486363195, 0.1287742692}}};
constexpr std::array<LineNode, 8> lucy_8{{{-0.9613200846, 0.099643152},
                                          {-0.7965052852, 0.2247039868},
                                          {-0.5259531492, 0.3132192966},
                                          {-0.1822781238, 0.3624335646},
                                          {0.1822781238, 0.3624335646},
                                          {0.5259531492, 0.3132192966},
                                          {0.7965052852, 0.2247039868},
                                          {0.9613200846, 0.099643152}}};

// Where the error reaches 2.9e-5 W(0). It grows with the length: as its square for short branches, as these rules do
// not integrate r² exactly, and as its cube where r³ at the centre dominates.
constexpr std::array<double, 9> longest{0, 0.0075, 0.101, 0.203, 0.258, 0.334, 0.412, 0.5, 0.59};

using Rules = std::array<std::span<const LineNode>, 9>;
constexpr Rules gauss{
    std::span<const LineNode>{}, gauss_1, gauss_2, gauss_3, gauss_4, gauss_5, gauss_6, gauss_7, gauss_8};
constexpr Rules lucy{std::span<const LineNode>{}, gauss_1, lucy_2, lucy_3, lucy_4, lucy_5, lucy_6, lucy_7, lucy_8};

std::size_t checked(int n) {
  if (n < 1 || n > 8) throw std::invalid_argument("a line rule of " + std::to_string(n) + " points is not offered");
  return static_cast<std::size_t>(n);
}

}  // namespace

std::span<const LineNode> gauss_rule(int n) {
  return gauss[checked(n)];
}

std::span<const LineNode> lucy_rule(int n) {
  return lucy[checked(n)];
}

double longest_branch(int n) {
  return longest[checked(n)];
}

LineDivision divide_branch(double length) {
  LineDivision division;
  division.parts = length > longest[8] ? static_cast<int>(std::ceil(length / longest[8])) : 1;
  while (length > division.parts * longest[static_cast<std::size_t>(division.points)] && division.points < 8)
    ++division.points;
  return division;
}

}  // namespace grainvdb
