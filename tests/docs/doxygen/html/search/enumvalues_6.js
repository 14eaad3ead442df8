var searchData=
[
  ['keep_0',['keep',['../cloud__file_8hpp.html#a0d38750bf7b7feadc76f6be15dfce836a18ccf61d533b600bbf5a963359223fe4',1,'keep()agrisee::io'],['../mesh__file_8hpp.html#a36e7163150bb8e3d4ce2f9c2b6c8ca54a18ccf61d533b600bbf5a963359223fe4',1,'keep()agrisee::io']]]
];
