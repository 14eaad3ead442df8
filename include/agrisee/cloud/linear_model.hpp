// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Linear models with Gaussian noise and Gaussian priors: posterior and evidence (Bishop, Pattern Recognition and
/// Machine Learning, 2006, 3.3 and 3.5). Cost: quadratic in the coefficients for each value, cubic once.
#pragma once

#include <agrisee/core/types.hpp>

#include <Eigen/Cholesky>

#include <cmath>

namespace agrisee::detail {

/// A linear model: y = B c + noise, with independent coefficients c that are normal about 0.
struct LinearModel {
  Eigen::MatrixXd B;         ///< transposed: one column for each value
  Eigen::VectorXd y;         ///< the values
  Eigen::VectorXd variance;  ///< of the noise of each value
  Eigen::VectorXd prior;     ///< variance of each c
};

/// The Gaussian posterior of a LinearModel.
struct LinearPosterior {
  Eigen::VectorXd mean;                     ///< of c
  Eigen::LLT<Eigen::MatrixXd> information;  ///< inverse covariance of c, factorised
  double evidence = 0.0;                    ///< logarithm of the probability density of y
};

/// The inverse covariance of the coefficients given the values; its lower half.
inline Eigen::MatrixXd information_of(const LinearModel& model) {
  Eigen::MatrixXd H = Eigen::MatrixXd(model.prior.cwiseInverse().asDiagonal());
  H.selfadjointView<Eigen::Lower>().rankUpdate(model.B * model.variance.cwiseSqrt().cwiseInverse().asDiagonal());
  return H;
}

/// The posterior of the coefficients, and the evidence for the model: the density of the values, with the coefficients
/// integrated out.
/// @param information as information_of() returns it
inline LinearPosterior linear_posterior(const LinearModel& model, const Eigen::MatrixXd& information) {
  LinearPosterior out;
  out.information.compute(information);
  const Eigen::VectorXd weighed = model.y.cwiseQuotient(model.variance);
  const Eigen::VectorXd rhs = model.B * weighed;
  out.mean = out.information.solve(rhs);
  const double log_det = out.information.matrixLLT().diagonal().array().log().sum();
  out.evidence = -0.5 * (weighed.dot(model.y) - rhs.dot(out.mean)) - log_det - 0.5 * model.prior.array().log().sum() -
                 0.5 * model.variance.array().log().sum() -
                 0.5 * static_cast<double>(model.y.size()) * std::log(kTwoPi);
  return out;
}
/// The same, with information_of(model).
inline LinearPosterior linear_posterior(const LinearModel& model) {
  return linear_posterior(model, information_of(model));
}

/// Values more standard deviations than this off count less in evidence.
constexpr double kFarOff = 3.0;

/// The evidence for a model if some of the values may be far off: their variances are raised to what they suggest, so
/// that a value t > 3 standard deviations off costs 4.5 + ln(t / 3) nats instead of t^2 / 2.
inline double robust_evidence(LinearModel model) {
  constexpr int kRounds = 4;
  const Eigen::VectorXd variance = model.variance;
  Eigen::MatrixXd information = information_of(model);
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::VectorXd residuals = model.y - model.B.transpose() * linear_posterior(model, information).mean;
    for (Eigen::Index i = 0; i < residuals.size(); ++i) {  // few change
      const double raised = std::max(variance[i], residuals[i] * residuals[i] / (kFarOff * kFarOff));
      if (raised == model.variance[i]) continue;
      information.selfadjointView<Eigen::Lower>().rankUpdate(model.B.col(i), 1.0 / raised - 1.0 / model.variance[i]);
      model.variance[i] = raised;
    }
  }
  return linear_posterior(model, information).evidence;
}

}  // namespace agrisee::detail
