// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/dcf_file.h"

#include <array>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace cia402::ros_node {
namespace {

namespace fs = std::filesystem;

std::string localTime(const char* format) {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  localtime_r(&now, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), format, &parts);
  return text.data();
}

}  // namespace

Result<bus::DcfStamp> dcfStamp(const std::string& axis, const std::string& path) {
  const fs::path file(path);
  if (file.extension() != ".dcf") {
    return Error{axis + ": \"" + path + "\" does not end in .dcf; write for example /tmp/" + axis +
                 ".dcf"};
  }
  std::error_code error;
  const fs::path absolute = fs::absolute(file, error);
  if (error || !fs::is_directory(absolute.parent_path(), error)) {
    return Error{axis + ": there is no folder " + absolute.parent_path().string()};
  }
  return bus::DcfStamp{file.filename().string(), localTime("%m-%d-%Y"), localTime("%I:%M%p")};
}

Result<std::string> writeDcfFile(const std::string& path, const std::string& text) {
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  fs::path part = absolute;
  part += ".part";
  std::ofstream file(part, std::ios::binary);
  file << text;
  file.close();
  if (!file) return Error{"cannot write " + part.string()};
  fs::rename(part, absolute, error);
  if (!error) return absolute.string();
  fs::remove(part, error);
  return Error{"cannot write " + absolute.string()};
}

Result<DcfText> readDcfFile(const std::string& axis, const std::string& path) {
  const fs::path file(path);
  if (file.extension() != ".dcf") {
    return Error{axis + ": \"" + path + "\" does not end in .dcf"};
  }
  std::error_code error;
  const auto size = fs::file_size(file, error);
  if (error || size > canopen::kLongestEds) {
    return Error{axis + ": \"" + path + "\" " +
                 (error ? "cannot be read: " + error.message() : "is too long for a DCF")};
  }
  std::ifstream stream(file, std::ios::binary);
  DcfText read;
  read.name = file.filename().string();
  read.text.assign(std::istreambuf_iterator<char>(stream), {});
  if (!stream) return Error{axis + ": \"" + path + "\" cannot be read"};
  return read;
}

}  // namespace cia402::ros_node
