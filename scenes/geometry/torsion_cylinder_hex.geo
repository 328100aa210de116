// Solid cylinder for torsion, see torsion_cylinder.geo, in hexahedra: a block of
// 2n x 2n in the middle, n out to the side, 2n along.
//
// Regions: body. Surfaces: bottom (z = 0), top (z = 1), side.
SetFactory("Built-in");
DefineConstant[ n = {3, Name "Parameters/boxes from the middle block to the side"} ];
Include "options.geo";

c = 0.45;   // radius of the corners of the middle block
Point(1) = {0, 0, 0};
For k In {0:3}
  Point(10 + k) = {c * Cos(Pi / 4 + k * Pi / 2), c * Sin(Pi / 4 + k * Pi / 2), 0};
  Point(20 + k) = {Cos(Pi / 4 + k * Pi / 2), Sin(Pi / 4 + k * Pi / 2), 0};
EndFor
For k In {0:3}
  m = (k + 1) % 4;
  Line(10 + k) = {10 + k, 10 + m};
  Circle(20 + k) = {20 + k, 1, 20 + m};
  Line(30 + k) = {10 + k, 20 + k};
EndFor
Curve Loop(1) = {10:13};
Plane Surface(1) = {1};
For k In {0:3}
  m = (k + 1) % 4;
  Curve Loop(2 + k) = {30 + k, 20 + k, -(30 + m), -(10 + k)};
  Plane Surface(2 + k) = {2 + k};
EndFor
Transfinite Curve{10:13, 20:23} = 2 * n + 1;
Transfinite Curve{30:33} = n + 1;
Transfinite Surface "*";
Recombine Surface "*";
v() = {}; top() = {}; side() = {};
For k In {1:5}
  out() = Extrude{0, 0, 1}{ Surface{k}; Layers{2 * n}; Recombine; };
  v() += out(1);
  top() += out(0);
  If (k > 1)
    side() += out(3);
  EndIf
EndFor
Physical Volume("body", 1) = {v()};
Physical Surface("bottom", 2) = {1:5};
Physical Surface("top", 3) = {top()};
Physical Surface("side", 4) = {side()};
ReverseMesh Surface{1:5};
