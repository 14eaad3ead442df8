var searchData=
[
  ['ellipsoid_2ehpp_0',['ellipsoid.hpp',['../ellipsoid_8hpp.html',1,'']]],
  ['error_2ehpp_1',['error.hpp',['../error_8hpp.html',1,'']]],
  ['evaluate_2ehpp_2',['evaluate.hpp',['../evaluate_8hpp.html',1,'']]],
  ['expected_5fsurface_2ehpp_3',['expected_surface.hpp',['../expected__surface_8hpp.html',1,'']]],
  ['experiment_2ehpp_4',['experiment.hpp',['../io_2experiment_8hpp.html',1,'(Global Namespace)'],['../study_2experiment_8hpp.html',1,'(Global Namespace)']]]
];
