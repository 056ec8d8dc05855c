#include "base/wrong_calls.h"

#include <Python.h>

#include <algorithm>
#include <array>
#include <new>
#include <string>
#include <string_view>
#include <vector>

// nanobind makes its messages about wrong calls itself, over several lines, and has no hook for others. The linker's
// option --wrap=PyErr_SetString (CMakeLists.txt) leads its calls of that function here.
void set_string(PyObject* type, const char* message) asm("__wrap_PyErr_SetString");
void set_pythons_string(PyObject* type, const char* message) asm("__real_PyErr_SetString");

void set_string(PyObject* type, const char* message) {
  if (type != PyExc_TypeError) return set_pythons_string(type, message);
  try {
    set_pythons_string(type, hardbody::python::in_one_line(message).c_str());
  } catch (const std::bad_alloc&) {
    set_pythons_string(type, message);
  }
}

namespace hardbody::python {
namespace {

constexpr std::string_view kBegin =
    "(): incompatible function arguments. The following argument types are supported:\n    1. ";
constexpr std::string_view kGiven = "\nInvoked with types: ";
constexpr std::string_view kKeywords = "kwargs = { ";
/// Modules whose names are left out in front of types.
constexpr std::array<std::string_view, 4> kModules = {"collections.abc.", "numpy.typing.", "numpy.", "typing."};
/// Package whose names are left out, with those of its private modules: "hardbody.Pose", "hardbody._core.Pose".
constexpr std::string_view kPackage = "hardbody.";

void remove_all(std::string& text, std::string_view part) {
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at)) text.erase(at, part.size());
}

void remove_package(std::string& text) {
  for (std::size_t at = text.find(kPackage); at != std::string::npos; at = text.find(kPackage, at)) {
    std::size_t end = at + kPackage.size();
    if (text.compare(end, 1, "_") == 0) end = std::min(text.find('.', end), text.size() - 1) + 1;
    text.erase(at, end - at);
  }
}

/// Returns a text without names of modules.
std::string short_names(std::string_view text) {
  std::string made(text);
  for (const std::string_view module : kModules) remove_all(made, module);
  remove_package(made);
  return made;
}

/// Returns the texts between commas.
std::vector<std::string_view> items(std::string_view text) {
  constexpr std::string_view kComma = ", ";
  std::vector<std::string_view> made;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(kComma), text.size());
    made.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + kComma.size(), text.size()));
  }
  return made;
}

/// Returns whether a signature has an argument of this name.
bool has_argument(std::string_view signature, std::string_view name) {
  const std::string first = '(' + std::string(name) + ':', other = ", " + std::string(name) + ':';
  return signature.find(first) != std::string_view::npos || signature.find(other) != std::string_view::npos;
}

/// Returns the first keyword of a call, "name: type", that its signature does not have; empty if it has all.
std::string_view unknown_keyword(std::string_view keywords, std::string_view signature) {
  for (const std::string_view keyword : items(keywords)) {
    const std::string_view name = keyword.substr(0, keyword.find(':'));
    if (!has_argument(signature, name)) return name;
  }
  return {};
}

}  // namespace

std::string in_one_line(std::string_view message) {
  const std::size_t begin = message.find(kBegin), end = message.rfind(kGiven);
  if (begin == std::string_view::npos || end == std::string_view::npos || end < begin) return std::string(message);
  std::string name(message.substr(0, begin));
  std::string signature = short_names(message.substr(begin + kBegin.size(), end - begin - kBegin.size()));
  signature.erase(std::min(signature.find('\n'), signature.size()));  // that of the first overload
  signature.erase(std::min(signature.rfind(" -> "), signature.size()));
  signature.erase(0, std::min(signature.find('('), signature.size()));
  std::string given = short_names(message.substr(end + kGiven.size()));

  std::string keywords;
  if (const std::size_t at = given.find(kKeywords); at != std::string::npos) {
    keywords = given.substr(at + kKeywords.size(), given.rfind(" }") - at - kKeywords.size());
    given = given.substr(0, at) + keywords;
  }
  if (name == "__init__") {  // the first argument is the object: its class is what the caller knows
    name = given.substr(0, given.find(','));
    given.erase(0, std::min(name.size() + 2, given.size()));
    if (signature.starts_with("(self")) signature.erase(1, signature.starts_with("(self, ") ? 6 : 4);
  }
  if (name.empty()) return "a property of (" + given + ") cannot be read; accepted: an initialised object of its class";
  const std::string accepted = "; accepted: " + name + signature;
  const std::string_view unknown = unknown_keyword(keywords, signature);
  if (!unknown.empty()) return std::string(unknown) + " is no argument of " + name + accepted;
  return name + " is called with (" + given + ')' + accepted;
}

}  // namespace hardbody::python
