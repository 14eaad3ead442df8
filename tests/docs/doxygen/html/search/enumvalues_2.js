var searchData=
[
  ['drop_0',['drop',['../cloud__file_8hpp.html#a0d38750bf7b7feadc76f6be15dfce836a6e9d25362c485bc3c90c818dfac5dc49',1,'agrisee::io']]],
  ['dropped_5fframe_1',['dropped_frame',['../fault__record_8hpp.html#ae4f3d4a4b53d10fa58fb0b9547a5cd33adbbe791e89cd071f705b8c3045c978d9',1,'agrisee::study']]]
];
