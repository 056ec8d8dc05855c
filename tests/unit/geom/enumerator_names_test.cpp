/// to_string: every public enumeration has it, and every enumerator a name of its own.

#include <ed/ed.h>

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

using ToString = std::string (*)(int);

template <class Enum>
std::string name(int value) {
  return to_string(static_cast<Enum>(value));
}

const std::map<std::string, ToString> kToString = {
    {"Answer", name<geom::Answer>},
    {"ContactRoot", name<ed::ContactRoot>},
    {"ContactStatus", name<ed::ContactStatus>},
    {"DerivativeStatus", name<geom::DerivativeStatus>},
    {"DistanceMethod", name<ed::DistanceMethod>},
    {"DistanceStatus", name<geom::DistanceStatus>},
    {"EquilibratedBy", name<ed::EquilibratedBy>},
    {"EventKind", name<ed::EventKind>},
    {"FailureReason", name<ed::FailureReason>},
    {"Finder", name<ed::Finder>},
    {"InstructionSet", name<geom::InstructionSet>},
    {"Lattice", name<ed::Lattice>},
    {"MissingReason", name<ed::MissingReason>},
    {"Neighbours", name<ed::Neighbours>},
    {"NewtonSystem", name<geom::NewtonSystem>},
    {"PatchKind", name<geom::PatchKind>},
    {"Penetration", name<geom::Penetration>},
    {"RayStatus", name<geom::RayStatus>},
    {"SeedStatus", name<geom::SeedStatus>},
    {"SizeDistribution", name<ed::SizeDistribution>},
};

/// Enumerations whose to_string says more than the name, or less.
const std::set<std::string> kInOtherWords = {"FailureReason", "Lattice"};

/// The enumerators of each `enum class` in the public headers, in their order; handles have none.
std::map<std::string, std::vector<std::string>> declared() {
  const std::filesystem::path root = std::filesystem::path(HARDBODY_REFERENCE_DIR).parent_path().parent_path();
  const std::regex enumeration(R"(enum class (\w+)[^{;]*\{([^}]+)\})");
  std::map<std::string, std::vector<std::string>> found;
  for (const char* directory : {"libgeom/include/geom", "libed/include/ed"}) {
    for (const auto& file : std::filesystem::directory_iterator(root / directory)) {
      if (!file.is_regular_file()) continue;
      std::ifstream stream(file.path());
      std::string text{std::istreambuf_iterator<char>(stream), {}};
      text = std::regex_replace(text, std::regex("//[^\n]*"), "");
      for (std::sregex_iterator i(text.begin(), text.end(), enumeration), end; i != end; ++i) {
        std::string body = (*i)[2];
        std::vector<std::string>& names = found[(*i)[1]];
        const std::regex word(R"((\w+)\s*(=[^,]*)?(,|$))");
        for (std::sregex_iterator j(body.begin(), body.end(), word); j != end; ++j) names.push_back((*j)[1]);
      }
    }
  }
  return found;
}

TEST(EnumeratorNames, OfAllPublicEnumerations) {
  const auto enumerations = declared();
  EXPECT_EQ(enumerations.size(), kToString.size());
  for (const auto& [enumeration, enumerators] : enumerations) {
    const auto to_string_of = kToString.find(enumeration);
    ASSERT_NE(to_string_of, kToString.end()) << enumeration << " has no to_string, or this test does not know of it";
    ASSERT_GE(enumerators.size(), 2U) << enumeration;
    std::set<std::string> names;
    for (std::size_t k = 0; k < enumerators.size(); ++k) {
      const std::string text = to_string_of->second(static_cast<int>(k));
      EXPECT_TRUE(text != "unknown" || enumerators[k] == text) << enumeration << "::" << enumerators[k];
      EXPECT_TRUE(names.insert(text).second) << enumeration << "::" << enumerators[k];
      if (!kInOtherWords.contains(enumeration)) {
        EXPECT_EQ(text, enumerators[k]) << enumeration;
      }
    }
  }
}

}  // namespace
