#include "run/equilibrated.h"

#include <fmt/format.h>

namespace hardbody {

std::string order_text(const ed::Relaxation& relaxation) {
  const ed::Order& order = relaxation.order;
  if (!order.nematic && !order.crystal) return "";
  std::string text = order.crystal ? "ordered positions" : "nematic";
  if (order.nematic) text += fmt::format(", S {:.3f} ({:.3f} in octants of the box)", order.S, order.S_octants);
  if (order.crystal) text += fmt::format(", S(q)/N up to {:.3f}", order.bragg);
  text += fmt::format("; Z changed by {:.2g} %", 100 * order.Z_change);
  if (order.nematic) text += fmt::format(", S by {:.2g}", order.S_change);
  if (order.crystal) text += fmt::format(", S(q)/N by {:.2g}", order.bragg_change);
  return text + " between the halves of the last two thirds";
}

std::string why_not_equilibrated(const ed::Relaxation& relaxation) {
  const ed::Order& order = relaxation.order;
  std::string decays = "C2 and F_self have not fallen below 0.05 twice in a row";
  if (!order.nematic && !order.crystal) return decays;
  if (!order.uniform) {
    return fmt::format("domains: S is {:.2f}, but {:.2f} on average in the octants of the box", order.S,
                       order.S_octants);
  }
  if (!order.crystal && !(relaxation.f_self < 0.05)) {
    return fmt::format("the nematic's F_self, {:.3f}, has not fallen below 0.05", relaxation.f_self);
  }
  return decays + ", nor are order and Z stationary: " + order_text(relaxation);
}

}  // namespace hardbody
