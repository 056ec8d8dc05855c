#pragma once

#include <algorithm>
#include <functional>
#include <iterator>

namespace hardbody {

/// Returns the first element of a list whose `member` equals `wanted`; nullptr if there is none.
template <class List, class Member, class Wanted>
auto* find_by(List& list, Member member, const Wanted& wanted) {
  const auto equal = [&](const auto& element) { return std::invoke(member, element) == wanted; };
  const auto found = std::find_if(std::begin(list), std::end(list), equal);
  return found == std::end(list) ? nullptr : &*found;
}

}  // namespace hardbody
