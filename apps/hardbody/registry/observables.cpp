#include "registry/observables.h"

#include "base/find.h"
#include "base/number_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hardbody {
namespace {

using ed::GroupResults;
using ed::Results;

constexpr const char* kRate = "sqrt(kT/m)/l";
constexpr const char* kDiffusion = "l sqrt(kT/m)";
constexpr const char* kTime = "l sqrt(m/kT)";
/// Text that is the same for all bodies.
PartText always(const char* text) {
  return [text](const Part& /*part*/) { return std::string(text); };
}

/// Text for all bodies and that for one species; an empty one leaves the observable out of its table.
PartText by_part(const char* all, const char* species) {
  return [=](const Part& part) { return std::string(part.whole != nullptr ? all : species); };
}

/// Number of rotation components that D_rot counts, and its divisor.
std::string rotation_remark(const Part& part) {
  const double axes = part.averaged_axes > 0 ? part.averaged_axes : part.rotation_axes;
  if (axes == 2) return "slope of <|integral of omega|^2>/4 over these lags: 2 components, world frame";
  if (axes == 3) return "slope of <|integral of omega|^2>/6 over these lags: 3 components, world frame";
  return fmt::format(
      "slope of <|integral of omega|^2>/{:.4g} over these lags: {:.4g} components on average, world frame", 2 * axes,
      axes);
}

std::string rotation_convention(const Part& part) {
  std::string divisor =
      "/ (2 c), c the number of components: 2 of bodies of revolution, spin excluded, 3 of others, of all their mean";
  if (part.rotation_axes == 2) divisor = "/ 4, two components, spin excluded";
  if (part.rotation_axes == 3) divisor = "/ 6, three components";
  return "slope of <|integral of omega dt|^2> " + divisor + ", world frame";
}

std::string c2_remark(const Part& part) {
  return part.rotation_axes == 2 ? "<P2(u(t).u(0))> = 1/e" : "<P2(u(t).u(0))> = 1/e, u body z";
}

std::string collective_remark(const Part& part) {
  if (part.results.decays_collective.empty()) return "";
  return "F(q, t) / S(q) = 1/e, at each wave number";
}

std::string f_self_remark(const Part& part) {
  if (part.wave_numbers.empty()) return "F_self = 1/e";
  return fmt::format("F_self(q, t) at q = {:.4g} / l = 1/e", part.wave_numbers[0]);
}

/// Text for bodies in cages; tables leave the observable out for others.
PartText of_cages(const char* text) {
  return [text](const Part& part) { return std::string(std::isfinite(part.results.msd_plateau.value) ? text : ""); };
}

/// Text for bodies with a director; tables leave the observable out for others.
PartText of_nematics(const char* text) {
  return [text](const Part& part) { return std::string(has_director(part.results) ? text : ""); };
}

/// Text for a known value of all bodies; tables leave out the observable otherwise.
PartText when_finite(ed::Estimate Results::*member, const char* text) {
  return [=](const Part& part) {
    return std::string(part.whole != nullptr && std::isfinite((part.whole->*member).value) ? text : "");
  };
}

std::string cubatic_remark(const Part& part) {
  return std::isfinite(part.results.cubatic_order.value) ? "of the three body axes: 1 for aligned cubes" : "";
}

std::string bragg_remark(const Part& part) {
  if (part.whole == nullptr || !std::isfinite(part.whole->bragg_peak.value)) return "";
  const ed::BraggRow& row = part.whole->bragg.at(0);
  return fmt::format("S(q)/N at q = {:.4g} / l, ({}, {}, {}) of the box", row.q, row.n.x(), row.n.y(), row.n.z());
}

std::string edges_remark(const Part& part) {
  return edges_differ(part.results) ? "slope of the MSD along that edge of the box / 2" : "";
}

std::string rotation_temperature_remark(const Part& part) {
  if (part.whole == nullptr) return fmt::format("on {} a body", part.rotation_axes);
  return "on " + freedoms_text(std::lround(part.rotation_axes * part.number), part.number);
}

// clang-format off
std::vector<Observable> built_in_observables() {
  return {
      {.key = "collision_rate", .symbol = "Γ", .name = "Collision rate", .unit = kRate,
       .definition = "collisions that a body takes part in, a time unit", .value = &GroupResults::collision_rate,
       .label = "collision rate", .remark = by_part("collisions of a body in a time unit", ""),
       .convention = always("collisions a body takes part in, a time unit"),
       .places = {.summary = 10, .reading = 10, .units = 40, .card = 80, .map = 60}},
      {.key = "Z", .symbol = "Z", .name = "Compressibility factor", .unit = "1", .definition = "P V / (N kT)",
       .value = &Results::Z, .label = "Z", .remark = always("P V / (N kT)"),
       .places = {.summary = 20, .reading = 20, .card = 10, .map = 40, .opened = 20}},
      {.key = "pressure_tensor", .name = "Pressure tensor", .unit = "1",
       .definition = "P V / (N kT) by directions, of trace 3 Z", .value = &Results::pressure,
       .convention = always("P V / (N kT), of trace 3 Z"), .places = {.summary = 30, .units = 50}},
      {.key = "D_trans", .symbol = "D_trans", .name = "Translational diffusion", .unit = kDiffusion,
       .definition = "slope of the MSD / 6", .value = &GroupResults::D_trans, .label = "D_trans",
       .remark = always("slope of MSD/6 over lags 0.4 to 1 of the longest"), .convention = always("slope of the MSD / 6"), .in_frames = true,
       .places = {.summary = 40, .reading = 30, .units = 10, .card = 20, .map = 10, .opened = 10}},
      {.key = "D_rot", .symbol = "D_rot", .name = "Rotational diffusion", .unit = kRate,
       .definition = "slope of ⟨|∫ω dt|²⟩, ω in the world frame", .value = &GroupResults::D_rot, .label = "D_rot",
       .remark = rotation_remark, .convention = rotation_convention,
       .of_orientation = true, .places = {.summary = 50, .reading = 40, .units = 20, .card = 30, .map = 20, .opened = 30}},
      {.key = "D_rot_body", .symbol = "D_rot,body", .name = "Rotational diffusion, body frame", .unit = kRate,
       .definition = "the same with ω along the body's axes", .value = &GroupResults::D_rot_body,
       .label = "D_rot_body", .remark = always("the same, components along the body's axes"),
       .convention = always("the same with the components along the body's axes accumulated"),
       .of_orientation = true, .places = {.summary = 60, .reading = 50, .units = 30, .card = 40}},
      {.key = "S", .symbol = "S", .name = "Nematic order", .unit = "1",
       .definition = "largest eigenvalue of Q of each frame, averaged; above 0.3 nematic", .value = &GroupResults::S,
       .label = "S",
       .remark = by_part("nematic order: largest eigenvalue of Q, by frame", "nematic order of this species"),
       .in_frames = true, .of_orientation = true, .places = {.summary = 70, .reading = 120, .card = 70, .map = 50}},
      {.key = "director", .name = "Director", .unit = "1",
       .definition = "eigenvector of the largest eigenvalue of Q, averaged over frames; its error in radians",
       .value = &GroupResults::director, .label = "director",
       .remark = of_nematics("of Q averaged over frames; the error in radians"),
       .convention = always("eigenvector of Q of its largest eigenvalue; the error in radians"), .in_frames = true,
       .of_orientation = true, .places = {.summary = 80, .reading = 122, .units = 60}},
      {.key = "D_parallel", .symbol = "D_∥", .name = "Diffusion along the director", .unit = kDiffusion,
       .definition = "slope of ⟨(Δr·n)²⟩ / 2, n the director at the time origin", .value = &GroupResults::D_parallel,
       .label = "D_parallel", .remark = of_nematics("slope of <(dr.n)^2>/2, n the director at the time origin"),
       .in_frames = true, .places = {.summary = 41, .reading = 32}},
      {.key = "D_perp", .symbol = "D_⊥", .name = "Diffusion across the director", .unit = kDiffusion,
       .definition = "slope of ⟨Δr² − (Δr·n)²⟩ / 4", .value = &GroupResults::D_perp, .label = "D_perp",
       .remark = of_nematics("slope of <dr^2 - (dr.n)^2>/4, across it"), .in_frames = true,
       .places = {.summary = 42, .reading = 34}},
      {.key = "D_box", .symbol = "D_box", .name = "Diffusion along the box's", .unit = kDiffusion,
       .definition = "slopes of ⟨Δx²⟩ / 2, ⟨Δy²⟩ / 2, ⟨Δz²⟩ / 2", .value = &GroupResults::D_box, .label = "D along",
       .remark = edges_remark, .in_frames = true, .of_box = true, .places = {.summary = 43, .reading = 36}},
      {.key = "cubatic_order", .symbol = "P₄", .name = "Cubatic order", .unit = "1",
       .definition = "largest ⟨Σ P₄(u·n)⟩ / (7/4) over directions n, u the three body axes: 1 for aligned cubes",
       .value = &GroupResults::cubatic_order, .label = "cubatic order", .remark = cubatic_remark, .in_frames = true,
       .places = {.summary = 81, .reading = 123, .card = 72}},
      {.key = "bragg_peak", .symbol = "S(q)/N", .name = "Strongest Bragg peak", .unit = "1",
       .definition = "largest S(q) / N of a wave vector, 1 for bodies on planes; at least 0.1 and 20 / N",
       .value = &Results::bragg_peak, .label = "Bragg peak", .remark = bragg_remark, .in_frames = true,
       .places = {.summary = 82, .reading = 124, .card = 74}},
      {.key = "smectic_order", .symbol = "τ_sm", .name = "Smectic order", .unit = "1",
       .definition = "|⟨exp(iq·r)⟩| of the strongest Bragg peak within 15° of the director", .value = &Results::smectic_order,
       .label = "smectic order", .remark = when_finite(&Results::smectic_order, "|<exp(iq.r)>| of the strongest Bragg peak along the director"),
       .in_frames = true, .places = {.summary = 83, .reading = 125}},
      {.key = "columnar_order", .symbol = "τ_col", .name = "Columnar order", .unit = "1",
       .definition = "the same within 15° of the plane across the director", .value = &Results::columnar_order, .label = "columnar order",
       .remark = when_finite(&Results::columnar_order, "the same across the director"), .in_frames = true, .places = {.summary = 84, .reading = 126}},
      {.key = "q4", .symbol = "q_4", .name = "Bond order q₄", .unit = "1",
       .definition = "Steinhardt's, of the nearest neighbours, averaged over bodies", .value = &Results::q4, .label = "q4",
       .remark = when_finite(&Results::q4, "Steinhardt's bond order, averaged over bodies"), .in_frames = true,
       .places = {.summary = 85, .reading = 127}},
      {.key = "q6", .symbol = "q_6", .name = "Bond order q₆", .unit = "1", .definition = "the same, of order 6",
       .value = &Results::q6, .label = "q6", .remark = when_finite(&Results::q6, "the same, of order 6"), .in_frames = true,
       .places = {.summary = 86, .reading = 128}},
      {.key = "psi6", .symbol = "ψ_6", .name = "Hexatic order ψ₆", .unit = "1",
       .definition = "|⟨ψ₆⟩| of each frame: six neighbours in a layer or in columns, bonds projected on the plane across the director", .value = &Results::psi6, .label = "psi6",
       .remark = when_finite(&Results::psi6, "hexatic order |<psi_6>| across the director, of all bodies of a frame"), .in_frames = true, .places = {.summary = 87, .reading = 129}},
      {.key = "psi6_local", .symbol = "ψ_6,loc", .name = "Local hexatic order", .unit = "1", .definition = "|ψ₆| of each body, averaged over bodies", .value = &Results::psi6_local, .label = "psi6 local", .remark = when_finite(&Results::psi6_local, "the same of each body, averaged: about 0.4 without order"), .in_frames = true, .places = {.summary = 88, .reading = 131}},
      {.key = "t_C2_1overe", .symbol = "t_C2", .name = "Orientational relaxation", .unit = kTime,
       .definition = "⟨P₂(u(t)·u(0))⟩ = 1/e", .value = &GroupResults::t_C2_1overe, .label = "t_C2(1/e)",
       .remark = c2_remark, .in_frames = true, .of_orientation = true, .places = {.summary = 110, .reading = 60, .card = 50, .map = 30}},
      {.key = "tau_C2", .symbol = "τ_C2", .name = "Relaxation time of C₂", .unit = kTime,
       .definition = "of the fit A exp[−(t/τ)^β]", .value = &GroupResults::tau_C2, .label = "tau_C2",
       .remark = always("of A exp[-(t/tau)^beta]"), .in_frames = true, .of_orientation = true, .places = {.summary = 90, .reading = 70}},
      {.key = "beta_C2", .symbol = "β_C2", .name = "Stretching of C₂", .unit = "1", .definition = "of the same fit",
       .value = &GroupResults::beta_C2, .label = "beta_C2", .remark = always("of the same"), .in_frames = true,
       .of_orientation = true, .places = {.summary = 100, .reading = 80}},
      {.key = "t_F_1overe", .symbol = "t_F", .name = "Relaxation of F_self", .unit = kTime,
       .definition = "F_self(q, t) = 1/e at the first wave number of the run", .value = &GroupResults::t_F_1overe,
       .label = "t_F(1/e)", .remark = f_self_remark, .in_frames = true,
       .places = {.summary = 140, .reading = 90, .card = 60}},
      {.key = "tau_F", .symbol = "τ_F", .name = "Relaxation time of F_self", .unit = kTime,
       .definition = "of the fit A exp[−(t/τ)^β]", .value = &GroupResults::tau_F, .label = "tau_F",
       .remark = always("of A exp[-(t/tau)^beta]"), .in_frames = true, .places = {.summary = 120, .reading = 100}},
      {.key = "beta_F", .symbol = "β_F", .name = "Stretching of F_self", .unit = "1", .definition = "of the same fit",
       .value = &GroupResults::beta_F, .label = "beta_F", .remark = always("of the same"), .in_frames = true,
       .places = {.summary = 130, .reading = 110}},
      {.key = "t_F_1overe_q", .symbol = "t_F", .name = "Relaxation of F_self at each wave number", .unit = kTime,
       .definition = "F_self(q, t) = 1/e, at each of `wave_numbers`", .value = &ed::ScatteringDecay::t_1overe,
       .in_frames = true, .places = {.summary = 141}},
      {.key = "tau_F_q", .symbol = "τ_F", .name = "Relaxation time of F_self at each wave number", .unit = kTime,
       .definition = "of the fit A exp[−(t/τ)^β] there", .value = &ed::ScatteringDecay::tau, .in_frames = true,
       .places = {.summary = 142}},
      {.key = "beta_F_q", .symbol = "β_F", .name = "Stretching of F_self at each wave number", .unit = "1",
       .definition = "of the same fit", .value = &ed::ScatteringDecay::beta, .in_frames = true,
       .places = {.summary = 143}},
      {.key = "t_F_collective_q", .symbol = "t_F,coll", .name = "Collective relaxation at each wave number", .unit = kTime,
       .definition = "F(q, t) / S(q) = 1/e, where `production.collective` asks for it",
       .value = CollectiveDecay{&ed::ScatteringDecay::t_1overe}, .label = "t_F_coll", .remark = collective_remark,
       .in_frames = true, .places = {.summary = 147, .reading = 113}},
      {.key = "tau_F_collective_q", .symbol = "τ_F,coll", .name = "Collective relaxation time at each wave number",
       .unit = kTime, .definition = "of the fit A exp[−(t/τ)^β] to F(q, t) / S(q)",
       .value = CollectiveDecay{&ed::ScatteringDecay::tau}, .in_frames = true, .places = {.summary = 148}},
      {.key = "beta_F_collective_q", .symbol = "β_F,coll", .name = "Collective stretching at each wave number",
       .unit = "1", .definition = "of the same fit", .value = CollectiveDecay{&ed::ScatteringDecay::beta},
       .in_frames = true, .places = {.summary = 149}},
      {.key = "msd_plateau", .symbol = "MSD_cage", .name = "Plateau of the MSD", .unit = "l^2",
       .definition = "MSD where it grows most slowly, as t^(1/2) at the most: a cage",
       .value = &GroupResults::msd_plateau, .label = "MSD plateau",
       .remark = of_cages("MSD where it grows most slowly: a cage"), .in_frames = true, .places = {.summary = 144, .reading = 112}},
      {.key = "chi4_peak", .symbol = "χ₄", .name = "Dynamic heterogeneity", .unit = "1",
       .definition = "largest χ₄(t) = N (⟨Q²⟩ − ⟨Q⟩²), Q the share of bodies moved by less than 0.3 diameters",
       .value = &GroupResults::chi4_peak, .label = "chi_4",
       .remark = of_cages("largest N (<Q^2> - <Q>^2), Q the share moved by less than 0.3 diameters"), .in_frames = true, .places = {.summary = 145, .reading = 114}},
      {.key = "t_chi4", .symbol = "t_χ4", .name = "Lag of that maximum", .unit = kTime, .definition = "where χ₄ is largest",
       .value = &GroupResults::t_chi4, .label = "t_chi4", .remark = of_cages("lag of that maximum"), .in_frames = true, .places = {.summary = 146, .reading = 116}},
      {.key = "q_peak", .symbol = "q_peak", .name = "First peak of S(q)", .unit = "1/l",
       .definition = "its wave number", .value = &GroupResults::q_peak, .label = "q_peak", .in_frames = true,
       .places = {.summary = 150, .reading = 130}},
      {.key = "S_peak", .symbol = "S(q_peak)", .name = "Height of that peak", .unit = "1", .definition = "S(q) there",
       .value = &GroupResults::S_peak, .in_frames = true, .places = {.summary = 160, .reading = 140}},
      {.key = "kT_trans", .symbol = "kT_trans", .name = "Translational temperature", .unit = "kT",
       .definition = "on 3N − 3 degrees of freedom; exactly 1 on average", .value = &GroupResults::translational_kT,
       .label = "kT_trans",
       .remark = by_part("on 3N - 3 degrees of freedom", "on its share of 3N - 3 degrees of freedom"),
       .places = {.summary = 170, .reading = 150, .card = 90}},
      {.key = "kT_rot", .symbol = "kT_rot", .name = "Rotational temperature", .unit = "kT",
       .definition = "the same of rotation", .value = &GroupResults::rotational_kT, .label = "kT_rot",
       .remark = rotation_temperature_remark, .of_orientation = true, .places = {.summary = 180, .reading = 160, .card = 100}},
      {.key = "D_rot_axes", .symbol = "D", .name = "Rotational diffusion about body", .unit = kRate,
       .definition = "⟨(∫ω dt)²⟩ / 2t, of that component", .value = &GroupResults::D_rot_axis, .label = "D_rot about",
       .remark = always("that component / 2t, body axis"), .of_orientation = true, .places = {.summary = 200, .reading = 180}},
      {.key = "t_C2_1overe_axes", .symbol = "t_C2", .name = "Orientational relaxation of body", .unit = kTime,
       .definition = "⟨P₂(u(t)·u(0))⟩ = 1/e of that axis", .value = &GroupResults::t_C2_1overe_axis,
       .label = "t_C2(1/e) of", .remark = always("u that body axis"), .of_orientation = true, .places = {.summary = 210, .reading = 190}},
      {.key = "kT_axes", .symbol = "kT", .name = "Rotational temperature about body", .unit = "kT",
       .definition = "equipartition: 1", .value = &GroupResults::axis_kT, .label = "kT_rot about",
       .remark = always("on N: one body axis"), .of_orientation = true, .places = {.summary = 190, .reading = 170}},
  };
}
// clang-format on

std::vector<Observable>& registered_observables() {
  static std::vector<Observable> all = built_in_observables();
  return all;
}

}  // namespace

const std::vector<Observable>& observables() {
  return registered_observables();
}

std::vector<const Observable*> observables_by(int Places::*place) {
  std::vector<const Observable*> list;
  for (const Observable& o : observables()) {
    if (o.places.*place != 0) list.push_back(&o);
  }
  std::stable_sort(list.begin(), list.end(),
                   [place](const Observable* a, const Observable* b) { return a->places.*place < b->places.*place; });
  return list;
}

std::vector<std::string> keys_by(int Places::*place) {
  std::vector<std::string> keys;
  for (const Observable* o : observables_by(place)) keys.push_back(o->key);
  return keys;
}

const Observable* find_observable(std::string_view key) {
  return find_by(observables(), &Observable::key, key);
}

bool is_per_axis(const Observable& observable) {
  return std::holds_alternative<std::array<ed::Estimate, 3> GroupResults::*>(observable.value);
}

bool is_per_wave_number(const Observable& observable) {
  return std::holds_alternative<ed::Estimate ed::ScatteringDecay::*>(observable.value) ||
         std::holds_alternative<CollectiveDecay>(observable.value);
}

bool is_list(const Observable& observable) {
  return is_per_axis(observable) || is_per_wave_number(observable);
}

bool is_number(const Observable& observable) {
  return !is_list(observable) && !std::holds_alternative<ed::Director GroupResults::*>(observable.value) &&
         !std::holds_alternative<ed::TensorEstimate Results::*>(observable.value);
}

std::string label_of(const Observable& observable, std::size_t number) {
  if (is_per_axis(observable)) return fmt::format("{} {}", observable.label, kBodyAxes[number]);
  return is_per_wave_number(observable) ? fmt::format("{} q{}", observable.label, number + 1) : observable.label;
}

std::string report_unit(const Observable& observable) {
  if (observable.unit == "1") return "";
  std::string unit = observable.unit;
  const std::size_t root = unit.find("sqrt");
  if (root != std::string::npos) unit.replace(root, 4, "√");
  return unit;
}

RegisteredObservable::RegisteredObservable(Observable observable) : key_(observable.key) {
  registered_observables().push_back(std::move(observable));
}

RegisteredObservable::~RegisteredObservable() {
  std::erase_if(registered_observables(), [this](const Observable& o) { return o.key == key_; });
}

}  // namespace hardbody
