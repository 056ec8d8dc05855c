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
  const double axes = part.rotation_axes;
  if (axes == 2) return "<|integral of omega|^2> / 4t: 2 components, world frame";
  if (axes == 3) return "<|integral of omega|^2> / 6t: 3 components, world frame";
  return fmt::format("<|integral of omega|^2> / {:.4g}t: {:.4g} components on average, world frame", 2 * axes, axes);
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

std::string f_self_remark(const Part& part) {
  if (part.wave_numbers.empty()) return "F_self = 1/e";
  return fmt::format("F_self(q, t) at q = {:.4g} / l = 1/e", part.wave_numbers[0]);
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
       .remark = always("MSD / 6t"), .convention = always("slope of the MSD / 6"), .in_frames = true,
       .places = {.summary = 40, .reading = 30, .units = 10, .card = 20, .map = 10, .opened = 10}},
      {.key = "D_rot", .symbol = "D_rot", .name = "Rotational diffusion", .unit = kRate,
       .definition = "slope of ⟨|∫ω dt|²⟩, ω in the world frame", .value = &GroupResults::D_rot, .label = "D_rot",
       .remark = rotation_remark, .convention = rotation_convention,
       .places = {.summary = 50, .reading = 40, .units = 20, .card = 30, .map = 20, .opened = 30}},
      {.key = "D_rot_body", .symbol = "D_rot,body", .name = "Rotational diffusion, body frame", .unit = kRate,
       .definition = "the same with ω along the body's axes", .value = &GroupResults::D_rot_body,
       .label = "D_rot_body", .remark = always("the same, components along the body's axes"),
       .convention = always("the same with the components along the body's axes accumulated"),
       .places = {.summary = 60, .reading = 50, .units = 30, .card = 40}},
      {.key = "S", .symbol = "S", .name = "Nematic order", .unit = "1",
       .definition = "largest eigenvalue of Q of each frame, averaged; above 0.3 nematic", .value = &GroupResults::S,
       .label = "S",
       .remark = by_part("nematic order: largest eigenvalue of Q, by frame", "nematic order of this species"),
       .in_frames = true, .places = {.summary = 70, .reading = 120, .card = 70, .map = 50}},
      {.key = "director", .name = "Director", .unit = "1",
       .definition = "eigenvector of the largest eigenvalue of Q, averaged over frames; its error in radians",
       .value = &GroupResults::director,
       .convention = always("eigenvector of Q of its largest eigenvalue; the error in radians"), .in_frames = true,
       .places = {.summary = 80, .units = 60}},
      {.key = "t_C2_1overe", .symbol = "t_C2", .name = "Orientational relaxation", .unit = kTime,
       .definition = "⟨P₂(u(t)·u(0))⟩ = 1/e", .value = &GroupResults::t_C2_1overe, .label = "t_C2(1/e)",
       .remark = c2_remark, .in_frames = true, .places = {.summary = 110, .reading = 60, .card = 50, .map = 30}},
      {.key = "tau_C2", .symbol = "τ_C2", .name = "Relaxation time of C₂", .unit = kTime,
       .definition = "of the fit A exp[−(t/τ)^β]", .value = &GroupResults::tau_C2, .label = "tau_C2",
       .remark = always("of A exp[-(t/tau)^beta]"), .in_frames = true, .places = {.summary = 90, .reading = 70}},
      {.key = "beta_C2", .symbol = "β_C2", .name = "Stretching of C₂", .unit = "1", .definition = "of the same fit",
       .value = &GroupResults::beta_C2, .label = "beta_C2", .remark = always("of the same"), .in_frames = true,
       .places = {.summary = 100, .reading = 80}},
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
       .remark = rotation_temperature_remark, .places = {.summary = 180, .reading = 160, .card = 100}},
      {.key = "D_rot_axes", .symbol = "D", .name = "Rotational diffusion about body", .unit = kRate,
       .definition = "⟨(∫ω dt)²⟩ / 2t, of that component", .value = &GroupResults::D_rot_axis, .label = "D_rot about",
       .remark = always("that component / 2t, body axis"), .places = {.summary = 200, .reading = 180}},
      {.key = "t_C2_1overe_axes", .symbol = "t_C2", .name = "Orientational relaxation of body", .unit = kTime,
       .definition = "⟨P₂(u(t)·u(0))⟩ = 1/e of that axis", .value = &GroupResults::t_C2_1overe_axis,
       .label = "t_C2(1/e) of", .remark = always("u that body axis"), .places = {.summary = 210, .reading = 190}},
      {.key = "kT_axes", .symbol = "kT", .name = "Rotational temperature about body", .unit = "kT",
       .definition = "equipartition: 1", .value = &GroupResults::axis_kT, .label = "kT_rot about",
       .remark = always("on N: one body axis"), .places = {.summary = 190, .reading = 170}},
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

bool is_number(const Observable& observable) {
  return !is_per_axis(observable) && !std::holds_alternative<ed::Director GroupResults::*>(observable.value) &&
         !std::holds_alternative<ed::TensorEstimate Results::*>(observable.value);
}

std::vector<ed::Estimate> numbers_of(const Observable& observable, const Part& part) {
  const ObservableValue& value = observable.value;
  if (const auto* member = std::get_if<ed::Estimate GroupResults::*>(&value)) return {part.results.**member};
  if (const auto* of = std::get_if<ed::Estimate (*)(const GroupResults&)>(&value)) return {(*of)(part.results)};
  if (const auto* member = std::get_if<ed::Estimate Results::*>(&value); member != nullptr && part.whole != nullptr) {
    return {part.whole->**member};
  }
  if (const auto* member = std::get_if<std::array<ed::Estimate, 3> GroupResults::*>(&value)) {
    const std::array<ed::Estimate, 3>& axes = part.results.**member;
    return {axes.begin(), axes.end()};
  }
  return {};
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
