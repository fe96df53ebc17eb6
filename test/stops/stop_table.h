// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The table of docs/stops.md: the worst of each stop in each mode, measured, and its bounds.
#pragma once

#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "stops/stop_judge.h"

namespace cia402::stops {

/// The worst cases of a stop in a mode: all those on time, and all those with a late cycle.
struct Row {
  enum Column { distance, distance_bound, time, time_bound, kColumns };
  std::array<double, kColumns> on_time{}, late{};

  void add(const Case& tested, const Verdict& verdict) {
    auto& worst = tested.late > 0ms ? late : on_time;
    worst[distance] = std::max(worst[distance], verdict.distance);
    worst[time] = std::max(worst[time], verdict.time);
    worst[distance_bound] = std::max(worst[distance_bound], verdict.bound.distance);
    worst[time_bound] = std::max(worst[time_bound], verdict.bound.time);
  }
};

constexpr char kTableBegin[] = "<!-- stops: begin -->";
constexpr char kTableEnd[] = "<!-- stops: end -->";

inline std::string tableFile() { return test::testFolder() + "/../docs/stops.md"; }

/// "halt | generic_cia402 cyclic_position", what a row is found by.
inline std::string rowName(Stop stop, const Mover& mover) {
  return std::string(toString(stop)) + " | " + mover.drive + " " + mover.mode +
         (mover.coasts ? ", coasting" : "");
}

inline std::string textOf(const std::string& name, const Row& row) {
  std::string text = "| " + name;
  char cell[64];
  for (const auto* part : {&row.on_time, &row.late}) {
    const bool none = (*part)[Row::distance_bound] == 0.0;
    for (const auto column : {Row::distance, Row::time}) {
      (void)std::snprintf(cell, sizeof cell,
                          column == Row::distance ? " | %.3f / %.3f" : " | %.2f / %.2f",
                          (*part)[column], (*part)[static_cast<std::size_t>(column) + 1]);
      text += none ? " | –" : cell;
    }
  }
  return text + " |";
}

/// The rows as they stand in the file.
inline std::map<std::string, Row> readTable() {
  std::map<std::string, Row> rows;
  std::ifstream file(tableFile());
  std::string line;
  bool inside = false;
  while (std::getline(file, line)) {
    if (line == kTableBegin) inside = true;
    if (line == kTableEnd) break;
    if (!inside || line.rfind("| ", 0) != 0) continue;
    std::vector<std::string> cells;
    std::istringstream parts(line.substr(1));
    for (std::string cell; std::getline(parts, cell, '|');) {
      const std::size_t from = cell.find_first_not_of(' ');
      const std::size_t to = cell.find_last_not_of(' ');
      if (from != std::string::npos) cells.push_back(cell.substr(from, to - from + 1));
    }
    if (cells.size() != 6) continue;
    Row row;
    for (std::size_t i = 0; i < 4; ++i) {
      auto& part = i < 2 ? row.on_time : row.late;
      const std::size_t column = i % 2 == 0 ? Row::distance : Row::time;
      char slash = 0;
      std::istringstream numbers(cells[i + 2]);
      numbers >> part[column] >> slash >> part[column + 1];
    }
    rows[cells[0] + " | " + cells[1]] = row;
  }
  return rows;
}

inline void writeTable(std::map<std::string, Row> rows, const std::vector<std::string>& order) {
  std::ifstream file(tableFile());
  std::string text, line;
  bool inside = false;
  while (std::getline(file, line)) {
    if (line == kTableEnd) inside = false;
    if (!inside) text += line + "\n";
    if (line != kTableBegin) continue;
    inside = true;
    text += "| stop | mode | rad | s | late: rad | late: s |\n|---|---|---|---|---|---|\n";
    for (const std::string& name : order) text += textOf(name, rows[name]) + "\n";
  }
  file.close();
  std::ofstream(tableFile()) << text;
}

/// What differs between what was measured and the file, in words.
inline std::string compare(const Row& measured, const Row& told) {
  // Half of the last digit, and a sample of a millisecond in which an axis may stand or not yet.
  constexpr std::array<double, Row::kColumns> kTolerances{0.0006, 0.0006, 0.0062, 0.0062};
  std::string text;
  for (const bool late : {false, true}) {
    const auto& now = late ? measured.late : measured.on_time;
    const auto& then = late ? told.late : told.on_time;
    for (std::size_t i = 0; i < Row::kColumns; ++i) {
      if (std::fabs(now[i] - then[i]) <= kTolerances[i]) continue;
      constexpr const char* kNames[] = {"distance", "bound of the distance", "time",
                                        "bound of the time"};
      text += std::string(late ? "late: " : "on time: ") + kNames[i] + " " + number(now[i]) +
              ", docs/stops.md says " + number(then[i]) + "\n";
    }
  }
  return text;
}

}  // namespace cia402::stops
