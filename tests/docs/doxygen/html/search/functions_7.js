var searchData=
[
  ['hashgrid_0',['HashGrid',['../classagrisee_1_1HashGrid.html#aa1a79c38f16ff366bddfea53f24e2b7e',1,'agrisee::HashGrid']]],
  ['herringbone_1',['herringbone',['../truss__layout_8hpp.html#af8b4e55ab31b6e293f5f8dbd86d7277a',1,'agrisee::study']]],
  ['hide_5fbehind_2',['hide_behind',['../truss__layout_8hpp.html#ae8f911329c21938d54dfee03f7b53f4e',1,'agrisee::study']]],
  ['highest_5fpoint_3',['highest_point',['../poses_8hpp.html#a5aa54aca797d0881e4e6349ab8bee6c5',1,'agrisee']]],
  ['housing_4',['housing',['../mount_8hpp.html#a18e37e5997aeedccd450e0c079684d0b',1,'agrisee::arm']]]
];
