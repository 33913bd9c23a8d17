// How the reference firmware introduces a robot whose builder writes more than ASCII. Prints what it says.
#include "floor.hpp"

int main() {
  Floor floor;
  periplus::Chassis chassis;
  chassis.name = "K\xC3\xA4" "fer";
  chassis.mount[3].name = "hinten\tlinks";
  periplus::Robot robot(floor, chassis, 1);
  robot.begin();
  fputs(floor.said.c_str(), stdout);
}
