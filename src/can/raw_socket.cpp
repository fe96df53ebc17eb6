// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "can/raw_socket.h"

#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>

namespace cia402::can {
namespace {

template <typename T>
bool setOption(int fd, int level, int option, const T& value) {
  return ::setsockopt(fd, level, option, &value, sizeof value) == 0;
}

can_frame toKernel(const Frame& frame) {
  can_frame raw{};
  raw.can_id = frame.id;
  if (frame.extended) raw.can_id |= CAN_EFF_FLAG;
  if (frame.remote) raw.can_id |= CAN_RTR_FLAG;
  raw.can_dlc = frame.size;
  std::memcpy(raw.data, frame.data.data(), frame.data.size());
  return raw;
}

Frame fromKernel(const can_frame& raw) {
  Frame frame;
  frame.error = (raw.can_id & CAN_ERR_FLAG) != 0;
  frame.extended = !frame.error && (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = !frame.error && (raw.can_id & CAN_RTR_FLAG) != 0;
  frame.id = raw.can_id & (frame.error || frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.size = std::min<std::uint8_t>(raw.can_dlc, CAN_MAX_DLEN);
  std::memcpy(frame.data.data(), raw.data, frame.data.size());
  return frame;
}

can_filter toKernel(const ReceiveFilter& filter) {
  can_filter raw{};
  raw.can_id = filter.id | (filter.extended ? CAN_EFF_FLAG : 0U);
  raw.can_mask = (filter.mask & (filter.extended ? CAN_EFF_MASK : CAN_SFF_MASK)) | CAN_EFF_FLAG;
  return raw;
}

}  // namespace

RawSocket::RawSocket() {
  for (std::size_t i = 0; i < kBatch; ++i) {
    vectors_[i].iov_base = &frames_[i];
    vectors_[i].iov_len = sizeof frames_[i];
    messages_[i].msg_hdr.msg_iov = &vectors_[i];
    messages_[i].msg_hdr.msg_iovlen = 1;
    messages_[i].msg_hdr.msg_control = controls_[i].bytes.data();
  }
}

RawSocket::~RawSocket() { close(); }

int RawSocket::open(int interface_index, const std::vector<ReceiveFilter>& filters,
                    int receive_buffer, bool error_frames) {
  close();
  fd_ = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (fd_ < 0) return errno;
  // Without these the socket still works: no stamp means the time of the read, and so on.
  setOption(fd_, SOL_SOCKET, SO_TIMESTAMPNS, 1);
  setOption(fd_, SOL_SOCKET, SO_RXQ_OVFL, 1);
  if (!setOption(fd_, SOL_SOCKET, SO_RCVBUFFORCE, receive_buffer)) {
    setOption(fd_, SOL_SOCKET, SO_RCVBUF, receive_buffer);
  }
  const can_err_mask_t errors = error_frames ? CAN_ERR_MASK : 0;
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = interface_index;
  int error = 0;
  if (!setOption(fd_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, errors)) error = errno;
  if (error == 0) error = setFilters(filters);
  if (error == 0 && ::bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    error = errno;
  }
  if (error != 0) {
    close();
    return error;
  }
  interface_index_ = interface_index;
  clock_.setEmptyAt(monotonicNow());
  return 0;
}

void RawSocket::close() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
  interface_index_ = 0;
  first_ = count_ = 0;
  drained_ = true;
  overflows_ = 0;
}

int RawSocket::setFilters(const std::vector<ReceiveFilter>& filters) {
  std::vector<can_filter> raw;
  for (const ReceiveFilter& filter : filters) raw.push_back(toKernel(filter));
  if (raw.empty()) raw.push_back(can_filter{});  // matches everything; no filter at all nothing
  const auto size = static_cast<socklen_t>(raw.size() * sizeof raw[0]);
  return ::setsockopt(fd_, SOL_CAN_RAW, CAN_RAW_FILTER, raw.data(), size) == 0 ? 0 : errno;
}

int RawSocket::send(const Frame& frame) {
  const can_frame raw = toKernel(frame);
  return ::send(fd_, &raw, sizeof raw, MSG_DONTWAIT | MSG_NOSIGNAL) < 0 ? errno : 0;
}

int RawSocket::read() {
  for (mmsghdr& message : messages_) {
    message.msg_hdr.msg_controllen = kControlSize;
    message.msg_hdr.msg_flags = 0;
  }
  const Time before = monotonicNow();
  first_ = count_ = 0;
  const int received = ::recvmmsg(fd_, messages_.data(), kBatch, MSG_DONTWAIT, nullptr);
  if (received < 0) {
    const int error = errno;
    drained_ = true;
    if (error == EAGAIN) clock_.setEmptyAt(before);
    return error;
  }
  clock_.setReading(readClocks());
  count_ = static_cast<std::size_t>(received);
  drained_ = count_ < kBatch;
  empty_after_batch_at_ = before;
  return 0;
}

std::optional<ReceivedFrame> RawSocket::pop() {
  if (first_ == count_) return std::nullopt;
  const ReceivedFrame received = convert(first_++);
  if (first_ == count_ && drained_) clock_.setEmptyAt(empty_after_batch_at_);
  return received;
}

ReceivedFrame RawSocket::convert(std::size_t index) {
  ReceivedFrame received{fromKernel(frames_[index]), clock_.timeOfReading()};
  msghdr& header = messages_[index].msg_hdr;
  for (cmsghdr* c = CMSG_FIRSTHDR(&header); c != nullptr; c = CMSG_NXTHDR(&header, c)) {
    if (c->cmsg_level != SOL_SOCKET) continue;
    if (c->cmsg_type == SO_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
      received.stamp =
          clock_.map(static_cast<std::int64_t>(stamp.tv_sec) * 1'000'000'000 + stamp.tv_nsec);
    } else if (c->cmsg_type == SO_RXQ_OVFL) {
      std::memcpy(&overflows_, CMSG_DATA(c), sizeof overflows_);
    }
  }
  return received;
}

}  // namespace cia402::can
