var searchData=
[
  ['fault_5frecord_2ehpp_0',['fault_record.hpp',['../fault__record_8hpp.html',1,'']]],
  ['fault_5freport_2ehpp_1',['fault_report.hpp',['../fault__report_8hpp.html',1,'']]],
  ['faults_2ehpp_2',['faults.hpp',['../faults_8hpp.html',1,'']]],
  ['files_2ehpp_3',['files.hpp',['../files_8hpp.html',1,'']]],
  ['fingerprint_2ehpp_4',['fingerprint.hpp',['../fingerprint_8hpp.html',1,'']]],
  ['fit_2ehpp_5',['fit.hpp',['../fit_8hpp.html',1,'']]],
  ['free_5fspace_2ehpp_6',['free_space.hpp',['../free__space_8hpp.html',1,'']]],
  ['frontier_2ehpp_7',['frontier.hpp',['../frontier_8hpp.html',1,'']]]
];
