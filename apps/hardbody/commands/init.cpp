#include "base/console.h"
#include "base/errors.h"
#include "commands/commands.h"
#include "config/text.h"
#include "io/text_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace hardbody {

int init(const std::string& path, const std::string& name) {
  const std::optional<std::string> found = template_text(name);
  if (!found) {
    throw InputError(fmt::format("--template {}: is not known; accepted: {}", one_line(name, 40), template_names()));
  }
  const std::string& text = *found;
  if (path.empty()) {
    console().print(text);
    return 0;
  }
  // x: fails if the file exists.
  std::FILE* file = std::fopen(path.c_str(), "wx");
  if (file == nullptr) {
    throw InputError(errno == EEXIST
                         ? fmt::format("{}: exists already; accepted: a new file", path)
                         : fmt::format("{}: cannot be written: {}; accepted: a new file", path, std::strerror(errno)));
  }
  const bool written = std::fputs(text.c_str(), file) >= 0;
  if (std::fclose(file) != 0 || !written) {
    throw InputError(fmt::format("{}: cannot be written completely; accepted: a new file on a disk with room", path));
  }
  console().print(fmt::format("{} written; next: hardbody {} {}\n", path, name == "sweep" ? "sweep" : "run", path));
  return 0;
}

}  // namespace hardbody
