#pragma once

#include <ed/equilibration.h>

#include <string>

namespace hardbody {

/// Describes the order of a nematic or a crystal in one clause: "nematic, S 0.71 (0.73 in octants of the box), S(q)/N
/// 0.01; Z changed by 0.2 % and S by 0.004 between the halves of the last two thirds". Empty for other states.
std::string order_text(const ed::Relaxation& relaxation);

/// Returns the reason for which a state does not count as equilibrated, without a full stop.
std::string why_not_equilibrated(const ed::Relaxation& relaxation);

}  // namespace hardbody
