// How many steps the reference firmware drives on while nobody says anything and the line gives back what the
// robot itself says, as half-duplex lines and modules that echo do. Prints it.
#include <stdio.h>

#include <string>

#include "periplus_robot.hpp"

namespace {
// A robot on an endless floor; its wheels do what they are told.
struct Floor : periplus::Hardware {
  double way = 0, speed = 0;
  uint64_t us = 0;
  std::string said;

  uint64_t micros() override { return us; }
  void drive(float ahead, float) override { speed = ahead; }
  void ticks(int32_t* left, int32_t* right) override { *left = *right = static_cast<int32_t>(way / 0.0005); }
  double heading() override { return 0; }
  uint16_t switches() override { return 0; }
  bool bumper() override { return false; }
  void write(const char* bytes, size_t count) override { said.append(bytes, count); }
};

void send(periplus::Robot& robot, const std::string& body) {
  char line[periplus::kLongestLine];
  const int all = snprintf(line, sizeof line, "%s*%04X\n", body.c_str(), periplus::crc16(body.data(), body.size()));
  for (int k = 0; k < all; ++k) robot.receive(static_cast<uint8_t>(line[k]));
}
}  // namespace

int main() {
  Floor floor;
  periplus::Robot robot(floor, periplus::Chassis(), 1);
  robot.begin();
  send(robot, "H 1 2A");
  send(robot, "M 1 400000 200 0 0 10000");
  int steps = 0;
  do {
    floor.us += 20000;
    floor.way += floor.speed * 0.02;
    robot.step();
    std::string echo;
    echo.swap(floor.said);
    for (char byte : echo) robot.receive(static_cast<uint8_t>(byte));
    ++steps;
  } while (floor.speed != 0 && steps < 400);
  printf("%d\n", steps);
}
