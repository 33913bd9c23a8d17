// A robot on an endless floor, and what a host says to it.
#pragma once
#include <stdio.h>

#include <string>

#include "periplus_robot.hpp"

// Its wheels do what they are told.
struct Floor : periplus::Hardware {
  double way = 0, speed = 0;
  uint64_t us = 0;
  bool pressed = false;
  std::string said;

  uint64_t micros() override { return us; }
  void drive(float ahead, float) override { speed = ahead; }
  void ticks(int32_t* left, int32_t* right) override { *left = *right = static_cast<int32_t>(way / 0.0005); }
  double heading() override { return 0; }
  uint16_t switches() override { return 0; }
  bool bumper() override { return pressed; }
  void write(const char* bytes, size_t count) override { said.append(bytes, count); }

  // One control step of 20 ms.
  void step(periplus::Robot& robot) {
    us += 20000;
    way += speed * 0.02;
    robot.step();
  }
};

inline void send(periplus::Robot& robot, const std::string& body) {
  char line[periplus::kLongestLine];
  const int all = snprintf(line, sizeof line, "%s*%04X\n", body.c_str(), periplus::crc16(body.data(), body.size()));
  for (int k = 0; k < all; ++k) robot.receive(static_cast<uint8_t>(line[k]));
}
