#include "base/suggest.h"

#include <algorithm>
#include <vector>

namespace hardbody {

std::string_view last_part(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  return dot == std::string_view::npos ? name : name.substr(dot + 1);
}

int edit_distance(std::string_view a, std::string_view b) {
  const std::size_t columns = b.size() + 1;
  std::vector<int> before(columns), above(columns), row(columns);
  for (std::size_t j = 0; j < columns; ++j) above[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j < columns; ++j) {
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, above);
    std::swap(above, row);
  }
  return above.back();
}

std::optional<std::string> nearest_name(std::string_view word, std::span<const std::string_view> known) {
  std::optional<std::string> nearest;
  // Fewer changes than there are letters: otherwise any name would match.
  const int letters = static_cast<int>(last_part(word).size());
  int least = std::min(std::max(2, letters / 2), letters - 1);
  for (const std::string_view name : known) {
    const int whole = edit_distance(word, name);
    // Plus one for the wrong section, so that a key of the right section is preferred.
    const int tail = edit_distance(last_part(word), last_part(name)) + 1;
    const int distance = std::min(whole, tail);
    if (distance > least || (nearest && distance == least)) continue;
    least = distance;
    nearest = std::string(name);
  }
  return nearest;
}

}  // namespace hardbody
