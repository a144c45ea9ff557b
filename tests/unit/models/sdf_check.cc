// Reads files as Gazebo does, and prints the number of links, joints and sensors of each, a line each.
#include <iostream>
#include <sdf/sdf.hh>

int main(int, char **argv)
{
  while (*++argv)
  {
    sdf::Root root;
    const auto errors = root.Load(*argv);
    for (const auto &error : errors)
      std::cerr << *argv << ": " << error << "\n";
    const sdf::Model *model = root.Model();
    if (!errors.empty() || !model)
      return 1;
    std::cout << model->LinkCount() << " " << model->JointCount() << " "
              << model->LinkByName("base_link")->SensorCount() << "\n";
  }
}
