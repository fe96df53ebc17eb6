// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/scene.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <sstream>

namespace cia402::campaign {

Result<Action> parseAction(const std::string& line) {
  std::istringstream in(line);
  std::string time;
  in >> time;
  char* end = nullptr;
  const double at = std::strtod(time.c_str(), &end);
  Action action;
  for (std::string word; in >> word;) action.words.push_back(word);
  if (time.empty() || *end != '\0' || action.words.empty()) {
    return Error{"not an action, as in \"3.204 halt a1\": \"" + line + "\""};
  }
  action.at = fromSeconds(at);
  return action;
}

std::string toString(const Action& action) {
  char time[32];
  std::snprintf(time, sizeof time, "%.6f", toSeconds(action.at));
  std::string text = time;
  while (text.back() == '0' && text[text.size() - 2] != '.') text.pop_back();
  for (const std::string& word : action.words) text += " " + word;
  return text;
}

Result<Scene> readScene(const std::string& yaml) try {
  const YAML::Node tree = YAML::Load(yaml);
  Scene scene;
  scene.about = tree["about"].as<std::string>("");
  scene.seed = tree["seed"].as<std::uint64_t>(1);
  if (!tree["robot"] || !tree["actions"]) return Error{"a scene has `robot` and `actions`"};
  scene.robot = YAML::Dump(tree["robot"]);
  for (const YAML::Node& line : tree["actions"]) {
    Result<Action> action = parseAction(line.as<std::string>());
    if (!action) return action.error();
    scene.actions.push_back(std::move(action).value());
  }
  std::stable_sort(scene.actions.begin(), scene.actions.end(),
                   [](const Action& a, const Action& b) { return a.at < b.at; });
  return scene;
} catch (const YAML::Exception& exception) {
  return Error{exception.what()};
}

std::string writeScene(const Scene& scene) {
  std::string text;
  if (!scene.about.empty()) {
    std::istringstream lines(scene.about);
    text += "about: |\n";
    for (std::string line; std::getline(lines, line);) text += "  " + line + "\n";
  }
  text += "seed: " + std::to_string(scene.seed) + "\nrobot:\n";
  std::istringstream lines(scene.robot);
  for (std::string line; std::getline(lines, line);) text += "  " + line + "\n";
  text += "actions:\n";
  for (const Action& action : scene.actions) text += "  - " + toString(action) + "\n";
  return text;
}

}  // namespace cia402::campaign
