#include "reference/ode/static_planes.h"

#include <ode/ode.h>

namespace lodestone {
namespace {

void append_planes(dSpaceID space, std::vector<StaticPlane>& planes) {
  for (int i = 0; i < dSpaceGetNumGeoms(space); ++i) {
    const dGeomID geom = dSpaceGetGeom(space, i);
    if (dGeomGetCategoryBits(geom) == 0) continue;  // hidden: an OdeWorld's own
    if (dGeomIsSpace(geom)) {
      append_planes(reinterpret_cast<dSpaceID>(geom), planes);
    } else if (dGeomGetClass(geom) == dPlaneClass && dGeomIsEnabled(geom)) {
      dVector4 plane;
      dGeomPlaneGetParams(geom, plane);
      planes.push_back({{plane[0], plane[1], plane[2]}, plane[3]});
    }
  }
}

}  // namespace

std::vector<StaticPlane> find_static_planes(dxSpace* space) {
  std::vector<StaticPlane> planes;
  append_planes(space, planes);
  return planes;
}

Vec3 gravity_of(dxWorld* world) {
  dVector3 gravity;
  dWorldGetGravity(world, gravity);
  return {gravity[0], gravity[1], gravity[2]};
}

}  // namespace lodestone
