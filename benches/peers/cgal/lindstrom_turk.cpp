// Measures CGAL's edge collapse with Lindstrom and Turk's memoryless cost and placement (default policies, no
// constraints, doubles): the quality to beat.
//
//   lindstrom_turk RUNS OUT_DIR MESH.ply...
//
// For each mesh and each share of its triangles prints the median CPU time of this thread in ms, loading and copying
// left out, and writes OUT_DIR/NAME.cgal_lt.PERCENT.ply. Meshes should be welded: `multires-peers simplify --out`
// writes such originals as NAME.original.ply. Non-manifold vertices are split, since CGAL's mesh cannot hold them.

#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <time.h>

namespace SMS = CGAL::Surface_mesh_simplification;
using Kernel = CGAL::Simple_cartesian<double>;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

// Stops at a number of triangles; CGAL 5.5 itself only counts edges, which is another share on open meshes.
struct Stop {
  std::size_t triangles;
  template <class Cost, class Profile>
  bool operator()(const Cost &, const Profile &profile, std::size_t, std::size_t) const {
    return profile.surface_mesh().number_of_faces() <= triangles;
  }
};

static double cpu_ms() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return now.tv_sec * 1e3 + now.tv_nsec * 1e-6;
}

static std::string stem(const std::string &path) {
  std::string name = path.substr(path.find_last_of('/') + 1);
  for (const char *end : {".ply", ".original"}) {
    const std::size_t at = name.rfind(end);
    if (at != std::string::npos && at + std::string(end).size() == name.size())
      name.resize(at);
  }
  return name;
}

static bool load(const std::string &path, Surface &mesh) {
  std::vector<Kernel::Point_3> points;
  std::vector<std::vector<std::size_t>> faces;
  if (!CGAL::IO::read_polygon_soup(path, points, faces))
    return false;
  namespace PMP = CGAL::Polygon_mesh_processing;
  PMP::orient_polygon_soup(points, faces);
  PMP::polygon_soup_to_polygon_mesh(points, faces, mesh);
  return mesh.number_of_faces() > 0;
}

int main(int count, char **arguments) {
  const int runs = count > 1 ? std::atoi(arguments[1]) : 0;
  if (count < 4 || runs < 1) {
    std::fprintf(stderr, "usage: lindstrom_turk RUNS OUT_DIR MESH.ply...\n");
    return 2;
  }
  const std::string directory = arguments[2];
  std::printf("%-20s %9s %-20s %5s %8s %8s %10s %10s\n", "mesh", "triangles", "contender", "%", "target", "reached",
              "median ms", "least ms");
  for (int argument = 3; argument < count; ++argument) {
    Surface input;
    if (!load(arguments[argument], input)) {
      std::fprintf(stderr, "%s: cannot be read as a mesh\n", arguments[argument]);
      return 1;
    }
    const std::size_t triangles = input.number_of_faces();
    const std::string name = stem(arguments[argument]);
    for (const int percent : {50, 25, 10, 5, 2, 1}) {
      const std::size_t target = triangles * percent / 100;
      std::vector<double> times;
      Surface mesh;
      for (int run = -1; run < runs; ++run) { // the first is a warm-up
        mesh = input;
        const double start = cpu_ms();
        SMS::edge_collapse(mesh, Stop{target},
                           CGAL::parameters::get_cost(SMS::LindstromTurk_cost<Surface>())
                               .get_placement(SMS::LindstromTurk_placement<Surface>()));
        if (run >= 0)
          times.push_back(cpu_ms() - start);
      }
      std::sort(times.begin(), times.end());
      const double median = (times[(runs - 1) / 2] + times[runs / 2]) / 2;
      mesh.collect_garbage();
      std::printf("%-20s %9zu %-20s %5d %8zu %8zu %10.2f %10.2f\n", name.c_str(), triangles, "cgal_lt", percent, target,
                  static_cast<std::size_t>(mesh.number_of_faces()), median, times.front());
      std::fflush(stdout);

      const std::string path = directory + "/" + name + ".cgal_lt." + std::to_string(percent) + ".ply";
      std::ofstream file(path, std::ios::binary);
      CGAL::IO::set_binary_mode(file);
      if (!CGAL::IO::write_PLY(file, mesh) || !file.flush()) {
        std::fprintf(stderr, "%s: cannot be written\n", path.c_str());
        return 1;
      }
    }
  }
  return 0;
}
