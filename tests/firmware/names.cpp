// How the reference firmware introduces a robot whose builder writes more than ASCII. Prints what it says.
#include <stdio.h>

#include "periplus_robot.hpp"

namespace {
struct Shelf : periplus::Hardware {
  uint64_t micros() override { return 0; }
  void drive(float, float) override {}
  void ticks(int32_t* left, int32_t* right) override { *left = *right = 0; }
  double heading() override { return 0; }
  uint16_t switches() override { return 0; }
  bool bumper() override { return false; }
  void write(const char* bytes, size_t count) override { fwrite(bytes, 1, count, stdout); }
};
}  // namespace

int main() {
  Shelf shelf;
  periplus::Chassis chassis;
  chassis.name = "K\xC3\xA4" "fer";
  chassis.mount[3].name = "hinten\tlinks";
  periplus::Robot robot(shelf, chassis, 1);
  robot.begin();
}
