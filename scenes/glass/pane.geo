// A pane of 140 x 140 x 4 mm in two layers of prisms over an unstructured triangulation. `gmsh -3 pane.geo -o pane.msh` made
// pane.msh; window.msh is the same with `-setnumber size 0.3 -setnumber edge 0.007`.
DefineConstant[ size = 0.14, edge = 0.0035, thickness = 0.004 ];
Point(1) = {-size / 2, -size / 2, -thickness / 2, edge};
Point(2) = {size / 2, -size / 2, -thickness / 2, edge};
Point(3) = {size / 2, size / 2, -thickness / 2, edge};
Point(4) = {-size / 2, size / 2, -thickness / 2, edge};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Extrude {0, 0, thickness} { Surface{1}; Layers{2}; }
Mesh.Algorithm = 5;
Mesh.MshFileVersion = 4.1;
Mesh.Binary = 1;
