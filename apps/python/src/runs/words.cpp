#include "runs/words.h"

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

namespace hardbody::python {
namespace {

using Words = std::pair<std::string_view, std::string_view>;

/// Beginnings of messages about an option's value.
constexpr std::array<Words, 5> kBeginnings = {{
    {"--set ", "overrides: "},
    {"--where ", "where: "},
    {"--force cannot be combined with --replicas", "force=True cannot be combined with replicas"},
    {"--time ", "time "},
    {"--longest-lag ", "longest_lag "},
}};

/// Phrases within messages: longer than an option, so that no file's name has one.
constexpr std::array<Words, 16> kPhrases = {{
    {"hardbody resume to continue it, or --force to overwrite it",
     "hardbody.resume to continue it, or force=True to overwrite it"},
    {"[grid] makes this a sweep: hardbody sweep takes it", "[grid] makes this a sweep: hardbody.sweep takes it"},
    {": results so far are written, hardbody resume continues",
     ": results so far are written, hardbody.resume(...) continues"},
    {"the start is not saved: hardbody resume begins", "the start is not saved: hardbody.resume(...) begins"},
    {" is a key of sweeps: hardbody sweep takes them", " is a key of sweeps: hardbody.sweep takes them"},
    {"a finished run: hardbody resume ", "a finished run: hardbody.resume of "},
    {": the same command continues", ": the same call continues"},
    {": --force would delete ", ": force=True would delete "},
    {"; --every N uses only every N-th", "; every=N uses only every N-th"},
    {"; accepted: --time-step, the time between two steps", "; accepted: time_step, the time between two steps"},
    {"; --longest-lag or a longer trajectory helps", "; longest_lag or a longer trajectory helps"},
    {", hardbody analyze --longest-lag or a longer run", ", hardbody.analyze with longest_lag or a longer run"},
    {"; --fit-from sets it", "; fit_from sets it"},
    {"no fits of decays: --fit-from T sets", "no fits of decays: fit_from sets"},
    {"has no [grid]: hardbody run takes", "has no [grid]: hardbody.run takes"},
    {"a sweep's config, as hardbody init --template sweep writes it",
     "a sweep's config, with {\"grid\": {key: values}}"},
}};

}  // namespace

std::string in_python(std::string message) {
  for (const auto& [option, argument] : kBeginnings) {
    if (message.starts_with(option)) message.replace(0, option.size(), argument);
  }
  for (const auto& [phrase, words] : kPhrases) {
    for (std::size_t at = message.find(phrase); at != std::string::npos; at = message.find(phrase, at + words.size())) {
      message.replace(at, phrase.size(), words);
    }
  }
  return message;
}

}  // namespace hardbody::python
