// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/memory_pages.h"

#include <link.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string_view>

namespace cia402::bus {
namespace {

constexpr std::size_t kLeastPage = 4096;                  // bytes
constexpr std::size_t kStackTouched = 64 * kLeastPage;    // bytes
constexpr std::size_t kHeapBlock = 16 * kLeastPage;       // bytes
constexpr std::size_t kHeapBlocks = 16;                   // 1 MB in all
constexpr std::array<std::string_view, 7> kLibraries = {  // by the start of their file names
    "libstdc++.so", "libm.so", "libgcc_s.so", "libc.so", "libpthread.so", "librt.so", "ld-linux"};

/// Locks whole pages, which brings them into memory, those to be written as pages of this process,
/// and reads them, which makes them known to kernels that leave that to the first use (user-mode
/// Linux). Where locking is refused the first write is a fault.
__attribute__((no_sanitize("address", "thread"))) void bringIn(std::uintptr_t begin,
                                                               std::uintptr_t end) {
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  begin -= begin % page;
  // NOLINTNEXTLINE(performance-no-int-to-ptr): an address from the kernel or the linker
  const auto* first = reinterpret_cast<const volatile char*>(begin);
  const std::size_t length = end - begin;
  (void)mlock(const_cast<const char*>(first), length);
  for (std::size_t at = 0; at < length; at += page) (void)first[at];
}

bool isUsedHere(std::string_view file) {
  if (file.empty()) return true;  // the program itself
  const std::string_view name = file.substr(file.rfind('/') + 1);
  return std::any_of(kLibraries.begin(), kLibraries.end(), [&](std::string_view library) {
    return name.substr(0, library.size()) == library;
  });
}

int bringInObject(dl_phdr_info* object, std::size_t, void*) {
  if (!isUsedHere(object->dlpi_name)) return 0;
  for (int i = 0; i < object->dlpi_phnum; ++i) {
    const ElfW(Phdr)& part = object->dlpi_phdr[i];
    if (part.p_type != PT_LOAD || (part.p_flags & PF_R) == 0) continue;
    const std::uintptr_t begin = object->dlpi_addr + part.p_vaddr;
    bringIn(begin, begin + part.p_memsz);
  }
  return 0;
}

/// What malloc() has taken of the process' data segment, "[heap]" in /proc/self/maps.
void bringInMainHeap() {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> maps(std::fopen("/proc/self/maps", "re"),
                                                             std::fclose);
  char line[512];
  while (maps && std::fgets(line, sizeof line, maps.get()) != nullptr) {
    std::uintptr_t begin = 0, end = 0;
    if (std::string_view(line).find("[heap]") == std::string_view::npos) continue;
    if (std::sscanf(line, "%" SCNxPTR "-%" SCNxPTR, &begin, &end) == 2) bringIn(begin, end);
  }
}

}  // namespace

void touchStack() {
  std::array<volatile char, kStackTouched> stack;
  for (std::size_t i = 0; i < stack.size(); i += kLeastPage) stack[i] = 0;
}

void touchHeap() {
  std::array<std::unique_ptr<volatile char[]>, kHeapBlocks> blocks;
  for (auto& block : blocks) {
    block.reset(new volatile char[kHeapBlock]);
    for (std::size_t i = 0; i < kHeapBlock; i += kLeastPage) block[i] = 0;
  }
  bringInMainHeap();
}

void touchProgram() { dl_iterate_phdr(bringInObject, nullptr); }

}  // namespace cia402::bus
