// Steps for which the reference firmware drives on once the bumper is pressed while a motion of it brakes
// because its time is up. Prints them, and the reason that is told.
#include <stdio.h>
#include <string.h>

#include "periplus_robot.hpp"

namespace {
// A robot on an endless floor; its wheels do what they are told.
struct Floor : periplus::Hardware {
  double way = 0, speed = 0;
  uint64_t us = 0;
  bool pressed = false;
  char why[8] = "none";

  uint64_t micros() override { return us; }
  void drive(float ahead, float) override { speed = ahead; }
  void ticks(int32_t* left, int32_t* right) override { *left = *right = static_cast<int32_t>(way / 0.0005); }
  double heading() override { return 0; }
  uint16_t switches() override { return 0; }
  bool bumper() override { return pressed; }
  void write(const char* bytes, size_t count) override {
    char line[periplus::kLongestLine + 1] = "";
    memcpy(line, bytes, count < sizeof line ? count : 0);
    sscanf(line, "d %*d %*d %7s", why);
  }
};

void send(periplus::Robot& robot, const char* body) {
  char line[periplus::kLongestLine];
  const int all = snprintf(line, sizeof line, "%s*%04X\n", body, periplus::crc16(body, strlen(body)));
  for (int k = 0; k < all; ++k) robot.receive(static_cast<uint8_t>(line[k]));
}
}  // namespace

int main() {
  Floor floor;
  periplus::Robot robot(floor, periplus::Chassis(), 1);
  robot.begin();
  send(robot, "H 1 2A");
  send(robot, "M 1 400000 200 0 0 1000");
  double before = 0;
  int steps = 0;
  for (int k = 0; k < 500 && !(floor.pressed && floor.speed == 0); ++k) {
    send(robot, "P 1 0");
    floor.us += 20000;
    floor.way += floor.speed * 0.02;
    robot.step();
    steps += floor.pressed;
    if (floor.speed < before) floor.pressed = true;
    before = floor.speed;
  }
  printf("%d %s\n", steps, floor.why);
}
