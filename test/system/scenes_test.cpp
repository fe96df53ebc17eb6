// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Every scene that the campaign or a person has ever found: none shows anything any more.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "campaign/runner.h"
#include "folders.h"

namespace cia402 {
namespace {

std::vector<std::string> sceneFiles() {
  std::vector<std::string> names;
  for (const auto& file :
       std::filesystem::directory_iterator(test::testFolder() + "/system/scenes")) {
    if (file.path().extension() == ".yaml") names.push_back(file.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

class Scenes : public testing::TestWithParam<std::string> {};

TEST_P(Scenes, ShowNothingAnyMore) {
  std::ifstream file(test::testFolder() + "/system/scenes/" + GetParam() + ".yaml");
  std::stringstream text;
  text << file.rdbuf();
  const auto scene = campaign::readScene(text.str());
  ASSERT_TRUE(scene) << scene.error().message;
  campaign::RunOptions options;
  options.config_folder = test::configFolder();
  const campaign::Report report = campaign::run(*scene, options);
  ASSERT_EQ(report.problem, "");
  for (const campaign::Finding& finding : report.findings) {
    ADD_FAILURE() << scene->about << "\n"
                  << finding.oracle << ": " << finding.axis << " " << finding.text << ", at "
                  << toSeconds(finding.at.time_since_epoch()) << " s";
  }
}

INSTANTIATE_TEST_SUITE_P(Of, Scenes, testing::ValuesIn(sceneFiles()),
                         [](const auto& scene) { return scene.param; });

}  // namespace
}  // namespace cia402
