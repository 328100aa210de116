// Bellows: a folded tube with thick ends, one closed chamber.
//
// Unit: meter. Axis y; the underside is y = -end. Each of the folds goes out
// from the valley radius to the crest radius and back.
//
// Regions: body. Surfaces: chamber (closed), clamped (underside), top, outer.
SetFactory("OpenCASCADE");
DefineConstant[ h = {0.0042, Name "Parameters/target edge length [m]"} ];
DefineConstant[ folds = {4, Name "Parameters/number of folds"} ];
Include "options.geo";

valley = 0.018;
crest = 0.030;
pitch = 0.016;
wall = 0.0030;
end = 0.005;
height = folds * pitch;
slant = Sqrt((crest - valley)^2 + (pitch / 2)^2);
offset = wall * slant / (pitch / 2);    // of the inner profile, along the radius

half = pitch / 2;
body_parts() = {};
void_parts() = {};
For i In {0 : 2 * folds - 1}
  low = (i % 2 == 0) ? valley : crest;
  high = (i % 2 == 0) ? crest : valley;
  Cone(100 + i) = {0, i * half, 0,  0, half, 0,  low, high};
  Cone(200 + i) = {0, i * half, 0,  0, half, 0,  low - offset, high - offset};
  body_parts() += {100 + i};
  void_parts() += {200 + i};
EndFor
Cylinder(300) = {0, -end, 0,  0, end, 0,  valley};
Cylinder(301) = {0, height, 0,  0, end, 0,  valley};
solid() = BooleanUnion{ Volume{body_parts()}; Delete; }{ Volume{300, 301}; Delete; };
hollow() = BooleanUnion{ Volume{200}; Delete; }{ Volume{void_parts({1 : #void_parts() - 1})}; Delete; };
shell() = BooleanDifference{ Volume{solid()}; Delete; }{ Volume{hollow()}; };
parts() = BooleanFragments{ Volume{shell()}; Delete; }{ Volume{hollow()}; Delete; };
Include "chamber.geo";

e = 1e-5;
R = crest + e;
clamped() = Surface In BoundingBox {-R, -end - e, -R,  R, -end + e, R};
top() = Surface In BoundingBox {-R, height + end - e, -R,  R, height + end + e, R};
outer() -= {clamped(), top()};

Physical Volume("body", 1) = {body()};
Physical Surface("chamber", 2) = {chamber()};
Physical Surface("clamped", 3) = {clamped()};
Physical Surface("top", 4) = {top()};
Physical Surface("outer", 5) = {outer()};

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
ReorientMesh Volume{body()};
