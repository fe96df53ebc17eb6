// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// docs/configuration.md lists the keys that the loader knows: no more, no less. What the loader
// knows it says itself, in its complaint about a key that it does not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "config/key_tables.h"
#include "config/loaded.h"

namespace cia402::config {
namespace {

using Names = std::set<std::string>;

constexpr const char* kNobodysKey = "qqqqqqqqqqqq";

/// Nothing but what must be given.
constexpr const char* kLeast = R"(
bus: {interface: can0}
axes: {a: {node_id: 1, drive: generic_cia402, counts_per_turn: 1000}}
)";

/// The same with a group, which knows its joints.
constexpr const char* kGrouped = R"(
bus: {interface: can0}
axes: {a: {node_id: 1, drive: generic_cia402, counts_per_turn: 1000}}
groups: {g: {joints: [a]}}
)";

/// A drive with modes that generic_cia402 has not, in which keys count that say nothing there.
constexpr const char* kOtherModes = R"(
bus: {interface: can0}
axes: {a: {node_id: 1, drive: id286_cnfa, counts_per_turn: 1000}}
)";
constexpr const char* kOfOtherModes[] = {"axes/a/position_loop", "axes/a/set_point_stream"};

/// Of both kinds of couplings, which know different keys.
constexpr const char* kOfCouplings = R"(
bus: {interface: can0}
axes:
  a: {node_id: 1, drive: generic_cia402, counts_per_turn: 1000}
  b: {node_id: 2, drive: generic_cia402, counts_per_turn: 1000}
couplings: [{joints: [j, k], axes: [a, b], matrix: [[1, 0], [0, 1]]}]
)";
constexpr const char* kOfAGantry = R"(
bus: {interface: can0}
axes:
  a: {node_id: 1, drive: generic_cia402, counts_per_turn: 1000}
  b: {node_id: 2, drive: generic_cia402, counts_per_turn: 1000}
couplings: [{joints: [j], axes: [a, b], skew: {window: 0.1}}]
)";

std::vector<std::string> partsOf(const std::string& path) {
  std::vector<std::string> parts;
  std::istringstream rest(path);
  for (std::string part; std::getline(rest, part, '/');) parts.push_back(part);
  return parts;
}

/// The tree with a value at a path, which ends in [0] where it is to stand in a list. What lies on
/// the way there and is no mapping becomes one.
YAML::Node with(const std::string& yaml, const std::string& path, const YAML::Node& value) {
  YAML::Node tree = YAML::Load(yaml), at = tree;
  for (std::string part : partsOf(path)) {
    const bool in_list = part.back() == ']';
    if (in_list) part.resize(part.size() - 3);
    if (!at.IsMap()) at = YAML::Node(YAML::NodeType::Map);
    YAML::Node next = at[part];
    if (in_list) {
      if (!next.IsSequence()) next = YAML::Node(YAML::NodeType::Sequence);
      if (next.size() == 0) next.push_back(YAML::Node(YAML::NodeType::Map));
      at.reset(next[0]);
    } else {
      at.reset(next);
    }
  }
  at = value;
  return tree;
}

Problems problemsOf(const YAML::Node& tree) {
  Problems problems;
  (void)loadRobot(tree, profilesIn({test::configFolder() + "/drives"}), problems);
  return problems;
}

/// What the loader says of a section at a path.
struct Section {
  std::optional<Names> known;  ///< its keys; nothing where the loader reads no section there
  bool wants_list = false;
};

Section sectionAt(const char* yaml, const std::string& path) {
  const std::string key = path + (path.empty() ? "" : "/") + kNobodysKey;
  const Problems problems = problemsOf(with(yaml, key, YAML::Node(1)));
  static const std::string kList = "unknown key; known are ";
  Section section;
  for (const Problem& problem : problems.list()) {
    if (problem.path == path && problem.message.find("must be a list") == 0) {
      section.wants_list = true;
    }
    if (problem.path != key || problem.message.find("unknown key") != 0) continue;
    EXPECT_EQ(problem.message.find(kList), 0u) << key << ": " << problem.message;
    Names known;
    std::istringstream names(problem.message.substr(kList.size()));
    for (std::string name; std::getline(names, name, ',');) {
      known.insert(name.substr(name.find_first_not_of(' ')));
    }
    section.known = known;
  }
  return section;
}

/// All sections that the loader reads below a path, with what it knows in each. `defaults` has the
/// keys of an axis.
void explore(const std::string& path, std::map<std::string, Names>& sections) {
  const Section section = sectionAt(kGrouped, path);
  if (section.wants_list) explore(path + "[0]", sections);
  if (!section.known) return;
  sections[path] = *section.known;
  for (const std::string& key : *section.known) {
    if (key != "defaults") explore(path.empty() ? key : path + "/" + key, sections);
  }
}

/// Those with free names are entered by one.
const std::map<std::string, Names>& sectionsOfTheLoader() {
  static const auto all = [] {
    std::map<std::string, Names> sections;
    for (const char* path : {"", "axes/a", "groups/g"}) explore(path, sections);
    for (const char* path : kOfOtherModes) {
      const Section section = sectionAt(kOtherModes, path);
      if (section.known) sections[path] = *section.known;
    }
    for (const char* yaml : {kOfCouplings, kOfAGantry}) {
      for (const char* path : {"couplings[0]", "couplings[0]/skew"}) {
        const Section section = sectionAt(yaml, path);
        if (section.known) sections[path].insert(section.known->begin(), section.known->end());
      }
    }
    return sections;
  }();
  return all;
}

/// Where the document tells of a section: a chapter with a table, and what its keys begin with
/// there; or, where it has no table, a row of another one, or text.
struct Place {
  std::string chapter, prefix;
};
const std::map<std::string, Place> kTables{
    {"", {"Top level", ""}},
    {"bus", {"bus", ""}},
    {"recorder", {"recorder", ""}},
    {"axes/a", {"axes/<name>", ""}},
    {"axes/a/error_control", {"error_control", ""}},
    {"axes/a/boot", {"boot", ""}},
    {"axes/a/homing", {"homing", ""}},
    {"axes/a/simulation", {"simulation", ""}},
    {"axes/a/frame", {"Frames", ""}},
    {"axes/a/frame/origin", {"Frames", "origin/"}},
    {"static_frames[0]", {"Frames", ""}},
    {"static_frames[0]/origin", {"Frames", "origin/"}},
    {"groups/g", {"groups/<name>", ""}},
    {"groups/g/constraints", {"groups/<name>", "constraints/"}},
    {"couplings[0]", {"couplings", ""}},
    {"couplings[0]/skew", {"couplings", "skew/"}},
};
/// The row of that key, the paragraph that begins so, or the chapter, whose code names the keys.
const std::map<std::string, Place> kInWords{
    {"axes/a/limits", {"limits", ""}},
    {"axes/a/identity", {"axes/<name>", "identity"}},
    {"axes/a/lss", {"axes/<name>", "lss"}},
    {"axes/a/parameters", {"axes/<name>", "parameters"}},
    {"axes/a/sdo", {"axes/<name>", "sdo"}},
    {"axes/a/position_loop", {"axes/<name>", "position_loop"}},
    {"axes/a/set_point_stream", {"axes/<name>", "set_point_stream"}},
    {"axes/a/feed_forward", {"axes/<name>", "feed_forward"}},
    {"axes/a/write[0]", {"PDOs", "`write` entries"}},
    {"groups/g/constraints/a", {"groups/<name>", "constraints/<joint>"}},
};
/// Read only to be refused with a reason.
const std::map<std::string, Names> kRefused{{"static_frames[0]", {"axis", "joint"}}};

Names namesOf(const std::map<std::string, KeyRow>& rows) {
  Names names;
  for (const auto& [name, row] : rows) names.insert(name);
  return names;
}

TEST(DocumentedKeys, AreThoseThatTheLoaderKnows) {
  const auto chapters = keyChapters();
  for (auto [path, known] : sectionsOfTheLoader()) {
    const auto table = kTables.find(path);
    if (table == kTables.end()) {
      EXPECT_EQ(kInWords.count(path), 1u) << path << " is in no table";
      continue;
    }
    Names documented = namesOf(keysBelow(chapters.at(table->second.chapter), table->second.prefix));
    if (kRefused.count(path) != 0) {
      for (const std::string& key : kRefused.at(path)) documented.insert(key);
    }
    for (const char* joint : {"a", "j", "k"}) {
      if (known.erase(joint) != 0) known.insert("<joint>");
    }
    EXPECT_EQ(known, documented) << "at `" << path << "`";
  }
}

TEST(DocumentedKeys, OfSmallSectionsAreNamedWhereTheseAreExplained) {
  const auto chapters = keyChapters();
  const auto& sections = sectionsOfTheLoader();
  for (const auto& [path, place] : kInWords) {
    EXPECT_EQ(sections.count(path), 1u) << "the loader reads no section " << path;
    if (sections.count(path) == 0) continue;
    const KeyChapter& chapter = chapters.at(place.chapter);
    std::string text = chapter.text;
    const std::size_t paragraph = text.find("\n" + place.prefix);
    if (!place.prefix.empty() && paragraph != std::string::npos) {
      text = text.substr(paragraph, text.find("\n\n", paragraph) - paragraph);
    }
    for (const KeyRow& row : chapter.rows) {
      if (row.keys[0] == place.prefix) text = row.text;
    }
    EXPECT_THAT(wordsOfCode(text), testing::IsSupersetOf(sections.at(path))) << path;
  }
}

TEST(DocumentedKeys, NoTableTellsOfASectionThatTheLoaderDoesNotRead) {
  const auto& sections = sectionsOfTheLoader();
  Names told;
  for (const auto& [path, place] : kTables) {
    EXPECT_EQ(sections.count(path), 1u) << path;
    told.insert(place.chapter);
  }
  for (const auto& [heading, chapter] : keyChapters()) {
    EXPECT_TRUE(chapter.rows.empty() || told.count(heading) == 1) << heading;
  }
}

TEST(DocumentedKeys, NothingButTheRequiredOnesMustBeGiven) {
  EXPECT_EQ(problemsOf(YAML::Load(kLeast)).text(), "");
  const auto chapters = keyChapters();
  const auto fallback = [&](const std::string& chapter, const std::string& key) {
    return keysBelow(chapters.at(chapter), "").at(key).fallback;
  };
  for (const char* key : {"bus", "axes"}) {
    EXPECT_EQ(fallback("Top level", key).find("required"), 0u) << key;
    YAML::Node tree = YAML::Load(kLeast);
    tree.remove(key);
    EXPECT_FALSE(problemsOf(tree).empty()) << key;
  }
  EXPECT_EQ(fallback("bus", "interface").find("required"), 0u);
  EXPECT_FALSE(problemsOf(with(kLeast, "bus", YAML::Node(YAML::NodeType::Map))).empty());
  for (const char* key : {"node_id", "drive", "counts_per_turn"}) {
    EXPECT_EQ(fallback("axes/<name>", key).find("required"), 0u) << key;
    YAML::Node tree = YAML::Load(kLeast);
    tree["axes"]["a"].remove(key);
    EXPECT_FALSE(problemsOf(tree).empty()) << key;
  }
}

}  // namespace
}  // namespace cia402::config
