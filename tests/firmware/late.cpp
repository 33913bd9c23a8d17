// What the reference firmware reports when it has run for long and has turned to the right. Prints the line.
#include <stdio.h>
#include <string.h>

#include "periplus_robot.hpp"

namespace {
// A robot that stands; 64 bits are needed for its time, and a sign for its heading.
struct Late : periplus::Hardware {
  uint64_t micros() override { return 12345678901ull; }
  void drive(float, float) override {}
  void ticks(int32_t* left, int32_t* right) override { *left = -12; *right = 40021; }
  double heading() override { return -3.2500004; }
  uint16_t switches() override { return 5; }
  bool bumper() override { return false; }
  void write(const char* bytes, size_t count) override {
    if (bytes[0] == 'r') fwrite(bytes, 1, count, stdout);
  }
};
}  // namespace

int main() {
  Late late;
  periplus::Robot robot(late, periplus::Chassis(), 1);
  robot.begin();
  for (int k = 0; k < 5; ++k) robot.step();
}
